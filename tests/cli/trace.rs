//! Traces of single pendulums: their columns, their flips, and the requests that are refused.

use std::fs;

use crate::program::*;

#[test]
fn a_trace_has_its_columns_and_its_flips() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["trace", "--start", "3,3", "--gravity", "1", "--until", "8", "--every", "0.5"];
    let output = flipmap(&folder, &[&arguments[..], &["-o", "t.csv", "--json"]].concat());
    assert!(output.status.success(), "{}", error_of(&output));
    let table = fs::read_to_string(folder.path().join("t.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines[0], "t,theta1,theta2,omega1,omega2,energy_error");
    assert_eq!(lines.len(), 1 + 17);
    assert!(lines[1].starts_with("0,3,3,0,0,"));
    let object: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let near = |key: &str, time: f64| (object[key].as_f64().unwrap() - time).abs() < 1e-12;
    assert!(
        near("second_flip", 1.767_916_558_420_626_6) && near("first_flip", 6.764_561_342_766_418)
    );
    let energy =
        lines.iter().skip(1).map(|line| line.rsplit(',').next().unwrap().parse::<f64>().unwrap());
    assert!(energy.fold(0.0, |worst: f64, e| worst.max(e.abs())) < 1e-28);
    let thrown = flipmap(&folder, &["trace", "--start", "0,0.5,3,-4", "--until", "0.1"]);
    assert!(String::from_utf8_lossy(&thrown.stdout).contains("\n0,0,0.5,3,-4,"), "its speeds");
}

#[test]
fn a_trace_has_the_columns_of_its_question() {
    let folder = tempfile::tempdir().unwrap();
    let last = |ask: &str| {
        let arguments =
            ["trace", "--start", "3,3", "--gravity", "1", "--until", "8", "--every", "1"];
        let (option, ask) = ask.split_once('=').unwrap_or(("--ask", ask));
        let output = flipmap(&folder, &[&arguments[..], &[option, ask]].concat());
        assert!(output.status.success(), "{}", error_of(&output));
        let table = String::from_utf8(output.stdout).unwrap();
        let named =
            table.lines().next().unwrap().split_once("energy_error,").unwrap().1.to_string();
        let rows: Vec<&str> = table.lines().skip(1).collect();
        let values = |row: &str| row.split(',').skip(6).map(str::to_string).collect::<Vec<_>>();
        (named, values(rows[0]), values(rows[8]))
    };
    let numbers =
        |texts: &[String]| -> Vec<f64> { texts.iter().map(|text| text.parse().unwrap()).collect() };
    let (named, begin, end) = last("first");
    assert_eq!((named.as_str(), begin), ("bob,time", vec![String::new(); 2]));
    assert!(numbers(&end)[0] == 2.0 && (numbers(&end)[1] - 1.767_916_558_420_626_6).abs() < 1e-12);
    let (named, begin, end) = last("flips");
    assert_eq!(named, "first_left,first_right,second_left,second_right");
    assert_eq!(numbers(&begin), [0.0; 4]);
    let counts = numbers(&end);
    assert!(counts[2] + counts[3] > 1.0, "{counts:?}");
    let (named, _, end) = last("state");
    assert_eq!(named, "turns1,turns2");
    // Turns are passes to the left less passes to the right.
    assert_eq!(numbers(&end), [counts[0] - counts[1], counts[2] - counts[3]]);
    let (named, _, end) = last("growth");
    // Returns the last `count` values of a pixel at the same start.
    let pixel = |ask: &str, count: usize| {
        let asked = ["--ask", ask, "--gravity", "1", "--budget", "8", "--size", "1x1"];
        let view = ["--center", "3,3", "--width", "1e-6", "--raw", "g.npy"];
        // A cell's tangents are known to about 1e-3, so the start is followed alone.
        let how = ["render", "--engine", "cpu", "--cells", "never"];
        let output = flipmap(&folder, &[&how[..], &asked, &view].concat());
        assert!(output.status.success(), "{}", error_of(&output));
        let bytes = fs::read(folder.path().join("g.npy")).unwrap();
        let values = bytes[bytes.len() - 8 * count..].as_chunks::<8>().0.iter();
        values.map(|bytes| f64::from_le_bytes(*bytes)).collect::<Vec<f64>>()
    };
    let value = pixel("growth", 1)[0];
    assert_eq!(named, "exponent");
    assert!((numbers(&end)[0] / value - 1.0).abs() < 1e-5, "{end:?} {value}");
    let (named, begin, end) = last("return");
    assert_eq!((named.as_str(), begin), ("distance,time", vec![String::new(); 2]));
    let (found, value) = (numbers(&end), pixel("return", 2));
    assert!((0..2).all(|k| (found[k] - value[k]).abs() < 1e-6), "{found:?} {value:?}");
    let (named, begin, end) = last("--count=2");
    assert_eq!((named.as_str(), begin), ("time", vec![String::new()]));
    assert!(numbers(&end)[0] > 1.8, "the first flip is at 1.77 s: {end:?}");
}

#[test]
fn exponents_do_not_depend_on_the_rows_before() {
    let folder = tempfile::tempdir().unwrap();
    let exponent = |every: &str| -> f64 {
        let start = ["trace", "--start", "2.29999999956,1.10000000044", "--until", "20"];
        let output =
            flipmap(&folder, &[&start[..], &["--ask", "growth", "--every", every]].concat());
        let text = String::from_utf8(output.stdout).unwrap();
        text.trim().rsplit(',').next().unwrap().parse().unwrap()
    };
    let (fine, coarse) = (exponent("0.5"), exponent("20"));
    assert!((fine / coarse - 1.0).abs() < 1e-9, "{fine} {coarse}");
}

#[test]
fn traces_with_bad_numbers_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&[&str], &str); 5] = [
        (&["--start", "3"], "--start"),
        (&["--start", "1,2,3"], "--start"),
        (&["--start", "x,3"], "--start"),
        (&["--start", "3,3", "--until", "-1"], "--until"),
        (&["--start", "3,3", "--every", "0"], "--every"),
    ];
    for (arguments, word) in cases {
        let output = flipmap(&folder, &[&["trace"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(error_of(&output).contains(word));
    }
}
