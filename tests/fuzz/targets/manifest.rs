//! Any text as the manifest of a folder.

#![no_main]

use iva_store::manifest::Manifest;
use iva_sweep::study::Table;
use libfuzzer_sys::{Corpus, fuzz_target};

fuzz_target!(|text: &str| -> Corpus {
    // What is refused is refused with one sentence.
    match Manifest::parse(text) {
        Err(said) => assert!(!said.is_empty() && !said.contains('\n'), "{said}"),
        Ok(manifest) => check(&manifest),
    }
    Corpus::Keep
});

/// Nothing in a manifest that is taken leads out of its folder or out of its plan.
fn check(manifest: &Manifest) {
    let is_table = |name: &String| Table::from_name(name).is_some();
    assert!(manifest.tables.iter().all(is_table));
    for input in &manifest.inputs {
        let plain = input.strip_prefix("inputs/").is_some_and(|rest| !rest.contains(['/', '\\']));
        assert!(plain && !input.contains(".."), "{input}");
    }
    for (number, part) in &manifest.parts {
        assert!(*number < manifest.plan().parts());
        assert!(part.failed <= part.points && part.points > 0);
        assert!(part.tables.keys().chain(part.errors.keys()).all(is_table));
    }
    assert!(manifest.done() <= manifest.points);
    assert_eq!(manifest.is_complete(), manifest.missing().next().is_none());
    assert_eq!(Manifest::parse(&manifest.text()).as_ref(), Ok(manifest));
}
