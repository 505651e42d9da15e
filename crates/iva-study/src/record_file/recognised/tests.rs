//! Files are made here of the marks and lines that the formats define: MATLAB's head of 116 characters, TDMS, RIFF,
//! HDF5, ZIP, NumPy's NPY and OLE2 by their first bytes; LVM, universal files (a mark in column 6, then the number of a
//! dataset), volume 2 of CSMIP and the COSMOS format 1.20 by their lines.

use std::path::Path;

use iva_sweep::forces::Selection;

use super::*;
use crate::Error;
use crate::record_file::{Unread, parse_record, parse_record_in_si};

const CSMIP: &str = "Corrected accelerogram   Chan  1: 360 Deg\nwords\n   2 points of accel data equally spaced at  \
                     .005 sec, in cm/sec2. (8f10.6)\n  1.000000  2.000000\n";
const COSMOS: &str = "Corrected acceleration   (Format v01.20 with 13 text lines)\n    2 acceleration pts, approx 4 secs, \
                      units=cm/sec2 (04), Format=(8F10.5)\n   1.00000   2.00000\n";

/// What a study says of a file.
fn said(contents: &[u8]) -> String {
    let path = Path::new("record.txt");
    assert!(parse_record(path, contents).is_err());
    match parse_record_in_si(path, contents, &Selection::default()) {
        Err(Unread::File(Error::Study(error))) => error.to_string(),
        other => panic!("expected an error, got {other:?}"),
    }
}

#[test]
fn files_are_known_by_their_content() {
    for (contents, kind) in [
        (&b"MATLAB 5.0 MAT-file, Platform: GLNXA64\0\0"[..], Mat),
        (b"MATLAB 7.3 MAT-file, Platform: GLNXA64\0\0", MatInHdf5),
        (b"TDSm\x0e\0\0\0", Tdms),
        (b"RIFF\x24\0\0\0WAVEfmt ", Wave),
        (b"    -1\r\n    58\r\n", Universal),
        (b"    -1\n   151\nmodel\n", Universal),
        (b"LabVIEW Measurement\t\nWriter_Version\t2\n", LabViewText),
        (CSMIP.as_bytes(), StrongMotion),
        (CSMIP.replace('\n', "\r\n").as_bytes(), StrongMotion),
        (COSMOS.as_bytes(), StrongMotion),
        (b"Uncorrected Accelerogram Data\n 1.0 2.0\n", RawStrongMotion),
        (b"\x89HDF\r\n\x1a\n\0", Hdf5),
        (b"PK\x03\x04\x14\0", Zip),
        (b"\x93NUMPY\x01\0", Npy),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", OldWorkbook),
    ] {
        assert_eq!(kind_of_file(contents), Some(kind));
        let said = said(contents);
        assert!(said.starts_with(&format!("record.txt: {}", kind.words())), "{said}");
        let has_call = said.contains("iva.Recorded.read(…).write(\"record.csv\") in Python");
        assert_eq!(
            has_call,
            kind.is_read_in_python() || [MatInHdf5, RawStrongMotion].contains(&kind)
        );
        assert!(!said.contains('\n'));
    }
}

#[test]
fn texts_that_are_read_are_none_of_them() {
    for text in [
        "",
        "time,force\n0,1\n1,2\n",
        "    -1\n     1\n",
        "# 2 points of accel data equally spaced at .005 sec\ndt = 0.005\n1 2\n",
        "800 points of accel data\n0 1\n1 2\n",
        "800 points of accel data equally spaced at noon\n0 1\n1 2\n",
        "2 acceleration pts, units=g\n0 1\n1 2\n",
        "A LINE\nANOTHER\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 2, DT= .01 SEC\n.1 .2\n",
    ] {
        assert_eq!(kind_of_file(text.as_bytes()), None, "{text}");
    }
}
