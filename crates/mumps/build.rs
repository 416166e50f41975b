//! Compiles the calls of MUMPS and MPI where they are asked for; no search for libraries: the compiler of MPI
//! knows its own, and MUMPS is where Debian has it.

fn main() {
    #[cfg(feature = "native")]
    native();
}

#[cfg(feature = "native")]
fn native() {
    println!("cargo:rerun-if-changed=src/calls.c");
    println!("cargo:rerun-if-env-changed=MPICC");
    let compiler = std::env::var("MPICC").unwrap_or_else(|_| "mpicc".to_owned());
    cc::Build::new()
        .compiler(compiler)
        .file("src/calls.c")
        .std("c11")
        .warnings(true)
        .compile("moreau_calls");
    println!("cargo:rustc-link-lib=dylib=dmumps");
    println!("cargo:rustc-link-lib=dylib=mpi");
}
