//! The reader of texts: storages, errors with their place, forms by name; files of either format.

use super::*;

#[test]
fn the_three_storages_say_the_same() {
    // W = [[2, 1], [0, 3]] by columns, q = (-1, 0.5), μ = 0.25, and something to ignore.
    let end = "-1 0.5\n0.25\n1\n";
    let dense = format!("2\n1\n0\n2\n2\n2\t2\n 2 0\n 1 3\n{end}");
    let blocks = format!("2 1 1 2 2  1 1 1  2  2  2 1  0 1  0  0 2 0 1 3 {end}");
    let triplets = format!(
        "2\n1\n2\n2\n2\n1\nCSparse\ntriplet: 2-by-2, nzmax: 3 nnz: 3\n0 0 : 2\n0 1 : 1\n1 1 : 3\n{end}"
    );
    let columns = format!(
        "2 1 2 2 2 2\nCSparse\n2-by-2, nzmax: 3 nnz: 3, 1-norm: 4\n col 0 : locations 0 to 0\n \
         0 : 2\n col 1 : locations 1 to 2\n 0 : 1\n 1 : 3\n{end}"
    );
    for text in [dense, blocks, triplets, columns] {
        let Ok(Problem::Local2(problem)) = read(&text, Form::Local) else {
            panic!("not read: {text}");
        };
        let own = problem.operator().diagonal(0);
        assert_eq!(own.as_slice(), [2.0, 0.0, 1.0, 3.0]);
        assert_eq!(problem.free()[0].as_slice(), [-1.0, 0.5]);
        assert_eq!(problem.laws()[0].coefficient(), 0.25);
    }
}

#[test]
fn errors_say_where() {
    let error = read("2\n1\n0 2 2\n2 2\n1 0 0\nx", Form::Local).expect_err("no number");
    assert_eq!(error.to_string(), "line 6: `x`, expected an entry");
    assert!(matches!(
        read("3\n1\n0 2 2 2 2 1 0 0 1", Form::Local),
        Err(SiconosError::Size {
            found: 2,
            expected: 3,
            ..
        })
    ));
    assert!(matches!(
        read("4 1", Form::Local),
        Err(SiconosError::Syntax { line: 1, .. })
    ));
    assert!(matches!(
        read("", Form::Global),
        Err(SiconosError::Syntax { .. })
    ));
}

#[test]
fn names_tell_the_form() {
    for (name, form) in [
        ("Rover1039.dat", Form::Local),
        ("GFC3D_TwoRods1.dat", Form::Global),
        ("GFC3D_TwoRods1-condensed.dat", Form::Local),
        (
            "gfc2d_granularflowonwall_00069_00350.condensed.dat",
            Form::Local,
        ),
        ("CubeH8.fclib-global.dat", Form::Global),
        ("Capsules-i125-1213.fclib-local.dat", Form::Local),
    ] {
        assert_eq!(Form::of_name(name), form, "{name}");
    }
}

/// Two contacts of different friction as the members of a group `fclib_local`, by columns.
#[cfg(feature = "hdf5")]
fn write_local(file: &hdf5::File) -> hdf5::Result<()> {
    let group = file.create_group("fclib_local")?;
    let numbers = |group: &hdf5::Group, name: &str, all: &[f64]| {
        group
            .new_dataset_builder()
            .with_data(all)
            .create(name)
            .map(|_| ())
    };
    let whole = |group: &hdf5::Group, name: &str, all: &[i32]| {
        group
            .new_dataset_builder()
            .with_data(all)
            .create(name)
            .map(|_| ())
    };
    whole(&group, "spacedim", &[2])?;
    let w = group.create_group("W")?;
    for (name, value) in [("m", 4), ("n", 4), ("nzmax", 6), ("nz", -1)] {
        whole(&w, name, &[value])?;
    }
    whole(&w, "p", &[0, 2, 3, 4, 5])?;
    whole(&w, "i", &[0, 2, 1, 2, 3])?;
    numbers(&w, "x", &[2.0, 0.5, 3.0, 4.0, 5.0])?;
    let vectors = group.create_group("vectors")?;
    numbers(&vectors, "q", &[-1.0, 0.1, -2.0, 0.2])?;
    numbers(&vectors, "mu", &[0.3, 0.4])
}

#[cfg(feature = "hdf5")]
#[test]
fn a_local_problem_in_hdf5_is_read() {
    let path = std::env::temp_dir().join(format!("moreau-{}.hdf5", std::process::id()));
    let file = hdf5::File::create(&path).expect("writable");
    write_local(&file).expect("written");
    drop(file);
    let problem = open(&path);
    let _ = std::fs::remove_file(&path);
    let Ok(Problem::Local2(problem)) = problem else {
        panic!("not read: {problem:?}");
    };
    assert_eq!(problem.operator().stored(), 3, "one block is zero");
    let (_, below) = problem.operator().row(1).next().expect("a block");
    assert_eq!(below[(0, 0)], 0.5);
    assert_eq!(problem.operator().diagonal(1)[(1, 1)], 5.0);
    assert_eq!(problem.free()[1].as_slice(), [-2.0, 0.2]);
    assert_eq!(problem.laws()[1].friction(), 0.4);
}

/// The same numbers in both formats, where the collection lies beside the workspace.
#[cfg(feature = "hdf5")]
#[test]
#[expect(clippy::print_stderr, reason = "says that it was skipped")]
fn both_formats_say_the_same() {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/frictional-contact/open");
    let pairs = [
        ("Capsules-i125-1213", "fclib-local"),
        ("LMGC_100_PR_PerioBox-i00361-60-03000", "fclib-local"),
        ("Box_Stacks-i0122-82-5", "fclib-global"),
        ("Spheres-i099-356-679", "fclib-global"),
        // One triangle of M only in HDF5.
        ("CubeH8", "fclib-global"),
        ("LMGC_GlobalFrictionContactProblem00046", "fclib-global"),
    ];
    if !folder.exists() {
        eprintln!("skipped: no collection of problems beside the workspace");
        return;
    }
    for (name, form) in pairs {
        let pair = [format!("{name}.hdf5"), format!("{name}.{form}.dat")]
            .map(|file| open(&folder.join(file)).expect(name));
        match pair {
            [Problem::Local3(a), Problem::Local3(b)] => {
                assert_eq!(a.operator(), b.operator(), "{name}");
                assert_eq!((a.free(), a.laws()), (b.free(), b.laws()), "{name}");
            }
            [Problem::Global3(a), Problem::Global3(b)] => {
                let sorted = |entries: &Entries| {
                    let mut entries: Entries =
                        entries.iter().filter(|e| e.2 != 0.0).copied().collect();
                    entries.sort_by(|a, b| a.partial_cmp(b).expect("finite"));
                    entries
                };
                assert_eq!(sorted(&a.stiffness), sorted(&b.stiffness), "{name}");
                assert_eq!(sorted(&a.directions), sorted(&b.directions), "{name}");
                assert_eq!((a.load, a.free), (b.load, b.free), "{name}");
                assert_eq!(a.friction, b.friction, "{name}");
            }
            other => panic!("{name}: {other:?}"),
        }
    }
}

#[cfg(not(feature = "hdf5"))]
#[test]
fn without_the_feature_it_is_named() {
    let error = open(Path::new("a.hdf5")).expect_err("not read");
    assert!(error.to_string().contains("feature `hdf5`"), "{error}");
}

#[cfg(feature = "hdf5")]
#[test]
fn what_is_no_hdf5_is_said() {
    let error = open(Path::new("no-such.hdf5")).expect_err("not read");
    assert!(matches!(error, SiconosError::Hdf5 { .. }), "{error}");
}
