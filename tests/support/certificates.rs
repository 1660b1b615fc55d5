//! Certificates that are written as files and read back.

use impellerc::ir::{Motion, Program};
use impellerc::report::certificate_file::{CertificateFile, Inputs, NcText};
use impellerc::report::proof::{details::details, head};
use impellerc::verify::Certificate;

/// Reads a certificate back from its file: its texts and its file are the same by bytes.
pub fn comes_back(program: &Program, motion: &Motion, certificate: &Certificate) {
    let file = |certificate: &Certificate| {
        let nc = NcText::new("any", "G17\n", Vec::new());
        CertificateFile::new(certificate, Inputs::new([]), nc).and_then(|file| file.json()).unwrap()
    };
    let text = file(certificate);
    let read = CertificateFile::read(&text).and_then(|file| file.certificate()).unwrap();
    assert!(file(&read) == text, "the file of {} is another one", certificate.name);
    assert_eq!(details(program, motion, &read), details(program, motion, certificate));
    assert_eq!(head::lines(&read), head::lines(certificate));
    // What comes back by its name.
    assert!(read.surfaces.iter().map(|s| s.id).eq(certificate.surfaces.iter().map(|s| s.id)));
    assert!(read.kept.surfaces.iter().map(|s| s.kind).eq(certificate.kept.surfaces.iter().map(|s| s.kind)));
    let rest = |c: &Certificate| -> Vec<_> { c.rest.iter().flat_map(|r| &r.surfaces).map(|s| s.id).collect() };
    assert_eq!(rest(&read), rest(certificate));
}
