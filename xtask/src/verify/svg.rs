//! Makes a stand-alone SVG picture part of a page; not a reader or writer of SVG.

/// The picture as an element of a page that may hold others: without prolog and embedded fonts, with
/// identifiers of its own, and with a view box so that it can be scaled.
///
/// `None` if the text is no SVG picture.
pub fn inline(picture: &str, prefix: &str) -> Option<String> {
    let start = picture.find("<svg")?;
    let length = picture[start..].find('>')?;
    let (opening, body) = picture[start..].split_at(length);
    let opening = match (attribute(opening, "viewBox"), size(opening)) {
        (None, Some((width, height))) => format!("{opening} viewBox=\"0 0 {width} {height}\""),
        _ => opening.to_owned(),
    };
    // All pictures of a page share one name space: two clip paths `c1` would be one.
    let own = |text: &str| {
        text.replace(" id=\"", &format!(" id=\"{prefix}-"))
            .replace("url(#", &format!("url(#{prefix}-"))
            .replace("href=\"#", &format!("href=\"#{prefix}-"))
    };
    Some(own(&opening) + &own(&without_fonts(body)))
}

/// Width and height in pixels.
fn size(opening: &str) -> Option<(f64, f64)> {
    let pixels = |name| {
        attribute(opening, name)?
            .trim_end_matches("px")
            .parse()
            .ok()
    };
    Some((pixels("width")?, pixels("height")?))
}

/// Value of an attribute of an opening tag.
fn attribute<'a>(opening: &'a str, name: &str) -> Option<&'a str> {
    let start = opening.find(&format!(" {name}=\""))? + name.len() + 3;
    opening[start..].split('"').next()
}

/// Without style elements that embed a font, a megabyte each: the page has fonts.
fn without_fonts(body: &str) -> String {
    let mut rest = body;
    let mut kept = String::with_capacity(body.len());
    while let Some(start) = rest.find("<style") {
        let end = rest[start..]
            .find("</style>")
            .map_or(rest.len(), |end| start + end + 8);
        kept.push_str(&rest[..start]);
        if !rest[start..end].contains("@font-face") {
            kept.push_str(&rest[start..end]);
        }
        rest = &rest[end..];
    }
    kept + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::samples;

    #[test]
    fn a_picture_gets_a_view_box_and_its_own_identifiers() {
        let svg = inline(samples::SVG, "f3").unwrap();
        assert!(svg.starts_with("<svg "), "no prolog: {svg}");
        assert!(svg.contains("viewBox=\"0 0 600 400\">"), "{svg}");
        assert!(
            svg.contains("id=\"f3-clip\"") && svg.contains("url(#f3-clip)"),
            "{svg}"
        );
    }

    #[test]
    fn a_view_box_that_is_there_stays() {
        let svg = "<svg viewBox=\"0 0 1 1\" width=\"9\" height=\"9\"></svg>";
        assert_eq!(inline(svg, "a").unwrap(), svg);
    }

    #[test]
    fn fonts_are_dropped_and_other_styles_kept() {
        let svg = "<svg><style>@font-face{}</style><style>g{}</style></svg>";
        assert_eq!(inline(svg, "a").unwrap(), "<svg><style>g{}</style></svg>");
    }

    #[test]
    fn a_text_that_is_no_picture_is_refused() {
        assert_eq!(inline("no picture", "a"), None);
    }
}
