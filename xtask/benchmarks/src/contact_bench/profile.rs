//! Performance profiles of E. D. Dolan and J. J. Moré (*Math. Program.* 91 (2002) 201-213): which part
//! of the problems a method solves within a multiple of the time of the fastest.

use moreau::plot::{Chart, PlotError, Style};

use super::outcome::{Best, Run};

/// Method, problem, and the seconds if it solved it.
pub type Time<'a> = (&'a str, &'a str, Option<f64>);

/// What is drawn of the runs: all methods of ours; of Siconos' solvers, which are many, those that solve
/// half of the problems, and together the best of them on every problem. Problems that Siconos was not
/// asked are left out where it was asked others.
pub fn times<'a>(runs: &'a [Run], known: &[Best]) -> Vec<Time<'a>> {
    let foreign = |run: &Run| run.method.starts_with("Siconos");
    let mut asked: Vec<&str> = runs
        .iter()
        .filter(|run| foreign(run))
        .map(|run| run.file.as_str())
        .collect();
    asked.dedup();
    let solved = |method: &str| {
        runs.iter()
            .filter(|run| run.method == method && run.solved())
            .count()
    };
    let drawn = |run: &&Run| {
        let compared = asked.is_empty() || asked.contains(&run.file.as_str());
        compared && (!foreign(run) || 2 * solved(&run.method) >= asked.len())
    };
    let time = |run: &'a Run| (run.method.as_str(), run.file.as_str(), run.success());
    let together = asked.iter().map(|file| {
        let best = known.iter().find(|best| best.file == *file);
        ("best of Siconos", *file, best.map(|best| best.seconds))
    });
    runs.iter()
        .filter(drawn)
        .map(time)
        .chain(together)
        .collect()
}

/// The profile as a picture; `None` if nothing was solved.
pub fn svg(times: &[Time<'_>]) -> Result<Option<String>, PlotError> {
    let curves = curves(times);
    let far = curves.iter().flat_map(|(_, steps)| steps).map(|p| p[0]);
    let end = 2.0 * far.fold(f64::NAN, f64::max);
    if !end.is_finite() {
        return Ok(None);
    }
    let title = "Part of the problems solved";
    let mut chart = Chart::new(
        title,
        "time over that of the fastest [–]",
        "part solved [–]",
    )
    .log_x()
    .x_range(1.0, end)
    .y_range(0.0, 1.0);
    for (method, mut steps) in curves {
        if let Some(last) = steps.last().copied() {
            steps.push([end, last[1]]);
            chart = chart.with(method, Style::Line, steps);
        }
    }
    chart.to_svg().map(Some)
}

/// Corners of the step function of every method, in the order in which the methods first occur.
fn curves<'a>(times: &[Time<'a>]) -> Vec<(&'a str, Vec<[f64; 2]>)> {
    let mut problems: Vec<&str> = times.iter().map(|time| time.1).collect();
    problems.sort_unstable();
    problems.dedup();
    let mut methods: Vec<&str> = Vec::new();
    for (method, ..) in times {
        if !methods.contains(method) {
            methods.push(method);
        }
    }
    let best = |problem: &str| {
        let of_problem = times.iter().filter(|time| time.1 == problem);
        of_problem
            .filter_map(|time| time.2)
            .fold(f64::INFINITY, f64::min)
    };
    let curve = |method| {
        let own = times.iter().filter(|time| time.0 == method);
        let mut ratios: Vec<f64> = own
            .filter_map(|time| Some(time.2? / best(time.1)))
            .collect();
        ratios.sort_by(f64::total_cmp);
        let part = |solved: usize| solved as f64 / problems.len() as f64;
        let corner = |(k, ratio): (usize, &f64)| [[*ratio, part(k)], [*ratio, part(k + 1)]];
        (method, ratios.iter().enumerate().flat_map(corner).collect())
    };
    methods.into_iter().map(curve).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_rise_with_the_ratio() {
        let times = [
            ("a", "one", Some(1.0)),
            ("b", "one", Some(4.0)),
            ("a", "two", None),
            ("b", "two", Some(3.0)),
        ];
        let curves = curves(&times);
        assert_eq!(curves[0], ("a", vec![[1.0, 0.0], [1.0, 0.5]]));
        assert_eq!(
            curves[1],
            ("b", vec![[1.0, 0.0], [1.0, 0.5], [4.0, 0.5], [4.0, 1.0]])
        );
        assert!(svg(&times).unwrap().unwrap().starts_with("<svg "));
        assert_eq!(svg(&[("a", "one", None)]).unwrap(), None);
    }

    #[test]
    fn rare_solvers_and_problems_of_one_side_are_left_out() {
        let run = |method: &str, file: &str, error| Run {
            file: file.to_owned(),
            method: method.to_owned(),
            contacts: 1,
            rank: None,
            residual: moreau::contact::Residual {
                scaled: error,
                of_load: error,
                unscaled: error,
            },
            iterations: 1,
            seconds: 1.0,
            end: String::new(),
        };
        let runs = [
            run("Auto", "a", 0.0),
            run("Siconos often", "a", 0.0),
            run("Siconos never", "a", 1.0),
            run("Auto", "b", 0.0),
        ];
        let known = super::super::outcome::best_of_siconos(&runs);
        let drawn: Vec<_> = times(&runs, &known)
            .iter()
            .map(|time| (time.0, time.1))
            .collect();
        assert_eq!(
            drawn,
            [
                ("Auto", "a"),
                ("Siconos often", "a"),
                ("best of Siconos", "a")
            ]
        );
        assert_eq!(times(&runs[3..], &[]).len(), 1);
    }
}
