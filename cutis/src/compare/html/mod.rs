//! The page: one file with everything inside, which asks for nothing from outside (its content security policy forbids
//! it, too).
//!
//! `page.html` is the frame, `page.css` its looks, `page.js` what moves, `self_test.js` what proves that it moves: it runs
//! when the address ends in `#selftest`, and writes its result into the page.

mod base64;
mod body;
mod figures;
mod views;

use super::Compared;
use super::report::Report;
pub use figures::{Figure, figures};
use miette::Result;

const FRAME: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");
const SELF_TEST: &str = include_str!("self_test.js");

/// The whole page.
pub fn page(report: &Report, compared: &Compared, figures: &[Figure]) -> Result<String> {
    let views = views::all(report, compared)?;
    let title = format!("{} — cutis compare", report.scene);
    // The body comes last: what it holds is not looked through for marks again.
    let filled = FRAME
        .replace("{{title}}", &escaped(&title))
        .replace("{{style}}", STYLE)
        .replace("{{script}}", SCRIPT)
        .replace("{{self_test}}", SELF_TEST);
    Ok(filled.replace("{{body}}", &body::body(report, &views, figures)))
}

/// Text that may hold anything, for text and attributes of the page.
fn escaped(text: &str) -> String {
    text.chars().fold(String::new(), |mut escaped, c| {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            c => escaped.push(c),
        }
        escaped
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_break_out() {
        assert_eq!(escaped("<a href=\"x\">'&"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;");
    }

    #[test]
    fn every_mark_is_filled() {
        for mark in ["{{title}}", "{{style}}", "{{script}}", "{{self_test}}", "{{body}}"] {
            assert_eq!(FRAME.matches(mark).count(), 1, "{mark}");
        }
        assert_eq!(FRAME.matches("{{").count(), 5);
    }
}
