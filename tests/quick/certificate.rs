//! A certificate is data: it comes back from its file.

use crate::support::certificates::comes_back;
use crate::support::pinned::{self, Pinned};
use impellerc::report::certificate_file::{CertificateFile, Inputs, NcText};

#[test]
fn certificates_come_back_from_their_files() {
    for part in [pinned::small("siemens-840d"), pinned::reduced("siemens-840d"), pinned::flank()] {
        let (program, motion) = part.planned();
        comes_back(program, motion, part.certificate());
    }
}

/// A file with another name of a surface or of a quantity, or without a figure, is no certificate.
#[test]
fn what_is_no_certificate_is_not_read() {
    let part: &Pinned = pinned::reduced("siemens-840d");
    let nc = NcText::new("any", "G17\n", Vec::new());
    let file = CertificateFile::new(part.certificate(), Inputs::new([]), nc).unwrap();
    assert!(file.certificate().is_ok());
    for (place, value, reason) in [
        ("/surfaces/0/surface", "vane 0 top", "`vane 0 top` is no surface"),
        ("/contracts/0/kind", "beauty", "`beauty` is no quantity of a contract"),
        ("/contracts/0/relation", "<", "unknown variant"),
        ("/perimeter/height", "high", "expected f64"),
    ] {
        let mut other = file.clone();
        *other.measured.pointer_mut(place).unwrap() = value.into();
        let found = other.certificate().unwrap_err();
        assert!(found.contains(reason), "{place}: {found}");
    }
}
