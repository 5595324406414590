//! What makes an estimate unreliable: bare words in the JSON object, sentences with a remedy in the summary, a table in the guide.

use crate::place::Place;

use serde_json::json;
use steklov_model::doubt::Doubt;

const GUIDE: &str = include_str!("../../../docs/guide/when-methods-fail.md");

#[test]
fn every_doubt_is_in_the_table_of_the_guide() {
    for doubt in Doubt::ALL {
        let (word, meaning, remedy) = (doubt.word(), doubt.meaning(), doubt.remedy());
        let row = format!("\n| `{word}` | {meaning} | {remedy} |\n");
        assert_eq!(GUIDE.matches(&row).count(), 1, "{row}");
        assert!(meaning.len() > 20 && remedy.len() > 10, "{word}");
        assert_eq!(Doubt::of_word(word), Some(*doubt));
    }
    let table = GUIDE.split("| doubt | what it means | what to do |\n|---|---|---|\n").nth(1).unwrap();
    let rows = table.lines().take_while(|line| line.starts_with('|')).count();
    assert_eq!(rows, Doubt::ALL.len());
    assert_eq!(Doubt::of_word("set"), None);
}

/// The lines about doubts.
fn told(text: &str) -> Vec<&str> {
    text.lines().filter(|line| line.starts_with("doubt ")).collect()
}

#[test]
fn the_summary_says_each_doubt_as_a_sentence() {
    let place = Place::new();
    let ran = place.run(["solve", "block.toml"]).demand(0);
    assert!(ran.out.contains("(not reliable: sets, coarse)"), "{}", ran.out);
    let sentences = [Doubt::Sets, Doubt::Coarse]
        .map(|doubt| format!("doubt       {}: {}. Remedy: {}", doubt.word(), doubt.meaning(), doubt.remedy()));
    assert_eq!(told(&ran.out), sentences);
    assert_eq!(told(&place.run(["show", "block.vtkhdf"]).demand(0).out), sentences);
    let o = place.run(["show", "--json", "block.vtkhdf"]).demand(0).json();
    assert_eq!(o["estimate_doubts"], json!(["sets", "coarse"]));
    // a patch test has none
    place.write(
        "patch.toml",
        std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/01-patch-test.toml")).unwrap(),
    );
    assert_eq!(told(&place.run(["solve", "patch.toml"]).demand(0).out), [""; 0]);
}
