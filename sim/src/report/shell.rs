//! What all pages have in common: one file that opens anywhere, with nothing fetched from elsewhere.
//!
//! The style is written into the page, and the policy forbids it to load anything. Without a script a page still says
//! all that it says.

use super::chart;
use super::html::escape;

pub struct Shell<'a> {
    pub title: &'a str,
    /// What kind of page it is, above the heading.
    pub product: &'a str,
    /// The heading, as text.
    pub heading: &'a str,
    /// Below it, as HTML.
    pub facts: &'a str,
    /// All else that is seen, as HTML.
    pub body: &'a str,
    /// The footer's text, as HTML.
    pub footer: &'a str,
    /// Data and scripts, as HTML.
    pub scripts: &'a str,
    /// What scripts may do beside running, in the words of the policy.
    pub script_policy: &'a str,
}

impl Shell<'_> {
    /// A page of these words without scripts.
    pub fn still<'a>(
        product: &'a str,
        heading: &'a str,
        facts: &'a str,
        body: &'a str,
    ) -> Shell<'a> {
        Shell {
            title: heading,
            product,
            heading,
            facts,
            body,
            footer: "",
            scripts: "",
            script_policy: "",
        }
    }

    /// The whole file.
    pub fn html(&self) -> String {
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'{script_policy}; \
             style-src 'unsafe-inline'; img-src data:\">\n\
             <title>{title}</title>\n<style>\n{style}{charts}</style>\n</head>\n<body>\n<header>\n<p class=\"product\">{product}</p>\n\
             <h1>{heading}</h1>\n{facts}</header>\n<main>\n{body}</main>\n<footer>{footer}</footer>\n{scripts}</body>\n</html>\n",
            script_policy = self.script_policy,
            title = escape(self.title),
            product = self.product,
            heading = escape(self.heading),
            facts = self.facts,
            body = self.body,
            footer = self.footer,
            scripts = self.scripts,
            style = include_str!("page.css"),
            charts = chart::STYLE,
        )
    }
}
