//! When the benches print the reports that are not criterion's.

/// Whether to print them: in a full bench run, and alone after `cargo bench … -- table` (a filter that no bench of
/// criterion's matches). Not in test runs, lists, or with any other filter or option.
pub fn reports_wanted() -> bool {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (harness, others): (Vec<&str>, Vec<&str>) =
        arguments.iter().map(String::as_str).partition(|&argument| argument == "--bench");
    !harness.is_empty() && (others.is_empty() || others == ["table"])
}
