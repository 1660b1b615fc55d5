//! `impellerc quote`: a bound that no certificate is below, on plans that are pinned, and what is printed.

use crate::support::part_alone;
use crate::support::pinned::{self, Pinned};
use impellerc::quotation;

/// The time of all moves of a plan, minutes.
fn planned(pinned: &Pinned) -> f64 {
    pinned.motion.operations.iter().flat_map(|o| &o.moves).map(|m| m.time).sum::<f64>() / 60.0
}

#[test]
fn no_plan_is_below_the_bound() {
    for pinned in [pinned::small("siemens-840d"), pinned::reduced("siemens-840d")] {
        let (found, time) = (quotation::quote(&pinned.program), planned(pinned));
        println!(
            "{}: at least {:.2} min, planned {time:.2} min, expected {:.2}",
            pinned.program.name, found.lower.minutes, found.expected
        );
        assert!(found.lower.minutes > 0.0 && found.lower.minutes <= time, "{found:?}");
        assert!(found.lower.minutes <= found.expected && found.operations.iter().all(|o| o.seconds > 0.0), "{found:?}");
    }
}

/// Chips are what the blank has over the part: for the small wheel the volumes are those that the stock simulation of the certificate finds.
#[test]
fn volumes_are_those_of_blank_and_part() {
    let stock = quotation::quote(&pinned::small("siemens-840d").program).stock;
    let field = pinned::small("siemens-840d").program.stock.field(0.25).unwrap();
    println!("{stock:?}, {} in cells", field.volume());
    assert!((stock.blank / field.volume() - 1.0).abs() < 2e-3, "{stock:?}");
    assert!(stock.part.is_some_and(|part| part > 0.4 * stock.blank && part < stock.blank));
}

#[test]
fn a_quote_is_printed_and_is_json() {
    let folder = part_alone::folder("");
    let run = |words: &[&str]| {
        let run = part_alone::run(folder.path(), words);
        (run.status.code(), String::from_utf8(run.stdout).unwrap(), String::from_utf8_lossy(&run.stderr).into_owned())
    };
    let (code, text, fault) = run(&["quote", "part.imp", "--hour-price", "90", "--kilogram-price", "8"]);
    assert_eq!(code, Some(0), "{fault}");
    for words in [
        "small: 8 blades, aluminium on 5mc850-c",
        "no program with these tools and feeds is below",
        "rough",
        "chips",
        "machining ",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let (code, text, fault) = run(&["quote", "part.imp", "--json"]);
    assert_eq!(code, Some(0), "{fault}");
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    let quote = &found["quote"];
    let [lower, expected, upper] =
        [&quote["lower"]["minutes"], &quote["expected"], &quote["upper"]].map(|value| value.as_f64().unwrap());
    assert!(0.0 < lower && lower < expected && expected < upper, "{text}");
    let (code, _, fault) = run(&["quote", "part.imp", "--hour-price=-4"]);
    assert!(code == Some(2) && fault.contains("not negative"), "{fault}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "a quote writes nothing");

    // A job that leaves all open has the same quote.
    let open = part_alone::folder("use tools \"five-axis\"\noperations auto\npost siemens-840d\n");
    let of_open = part_alone::run(open.path(), &["quote", "part.imp", "--json"]);
    assert_eq!(String::from_utf8(of_open.stdout).unwrap(), text, "{}", String::from_utf8_lossy(&of_open.stderr));
}
