//! The same bytes on every platform: the results do not depend on the elementary functions of the C library.

#![cfg(target_os = "linux")]

use std::path::Path;
use std::process::Command;

/// A library that stands before the C library and gives each elementary function another last digit, as that of another
/// platform may.
const OTHER_LIBRARY: &str = r#"
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdint.h>
#include <string.h>

static double other(double x) {
    uint64_t bits;
    memcpy(&bits, &x, 8);
    bits ^= 1;
    memcpy(&x, &bits, 8);
    return x;
}

#define ONE(name) double name(double x) { \
    static double (*real)(double); \
    if (!real) real = (double (*)(double))dlsym(RTLD_NEXT, #name); \
    return other(real(x)); }
#define TWO(name) double name(double x, double y) { \
    static double (*real)(double, double); \
    if (!real) real = (double (*)(double, double))dlsym(RTLD_NEXT, #name); \
    return other(real(x, y)); }

ONE(sin) ONE(cos) ONE(tan) ONE(asin) ONE(acos) ONE(atan) ONE(sinh) ONE(cosh) ONE(tanh) ONE(asinh) ONE(acosh) ONE(atanh)
ONE(exp) ONE(exp2) ONE(expm1) ONE(log) ONE(log2) ONE(log10) ONE(log1p) ONE(cbrt)
TWO(atan2) TWO(hypot) TWO(pow)

void sincos(double x, double *s, double *c) { *s = sin(x); *c = cos(x); }
"#;

/// Asks the stand-in for a cosine, so that a library that does nothing is not taken for a proof.
const PROBE: &str = r#"
#include <math.h>
#include <stdio.h>
int main(int n, char **a) { printf("%a", cos(1.0 + n)); return 0; }
"#;

fn compiled(folder: &Path, name: &str, source: &str, more: &[&str]) -> Option<std::path::PathBuf> {
    let (from, to) = (folder.join(format!("{name}.c")), folder.join(name));
    std::fs::write(&from, source).unwrap();
    let run = Command::new("cc").arg(&from).arg("-o").arg(&to).args(["-fno-builtin", "-w"]).args(more).output().ok()?;
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    Some(to)
}

#[test]
fn nc_and_certificate_do_not_depend_on_the_c_library() {
    let folder = tempfile::tempdir().unwrap();
    let library = compiled(folder.path(), "other.so", OTHER_LIBRARY, &["-shared", "-fPIC", "-ldl", "-lm"]);
    let (Some(library), Some(probe)) = (library, compiled(folder.path(), "probe", PROBE, &["-lm"])) else {
        eprintln!("skipped: there is no C compiler");
        return;
    };
    let said = |preload: Option<&Path>| {
        let mut run = Command::new(&probe);
        if let Some(library) = preload {
            run.env("LD_PRELOAD", library);
        }
        run.output().unwrap().stdout
    };
    assert_ne!(said(None), said(Some(&library)), "the stand-in changes nothing");
    let made = |preload: Option<&Path>, name: &str| {
        let (nc, certificate) = (folder.path().join(name), folder.path().join(format!("{name}.json")));
        let mut run = Command::new(env!("CARGO_BIN_EXE_impellerc"));
        run.arg("jobs/small/small.imp").arg("-o").arg(&nc).arg("--certificate").arg(&certificate);
        if let Some(library) = preload {
            run.env("LD_PRELOAD", library);
        }
        let run = run.output().unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        (std::fs::read(nc).unwrap(), std::fs::read(certificate).unwrap())
    };
    let (here, there) = (made(None, "here"), made(Some(&library), "there"));
    assert!(here == there, "the bytes depend on the C library");
}
