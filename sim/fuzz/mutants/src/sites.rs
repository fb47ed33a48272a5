//! Where a source file can be changed: operators, limits, constants, results and statements, found in its syntax tree.
//!
//! Every mutant becomes a choice at run time: `a < b` is rewritten to `(if at(7) { (a) <= (b) } else { a < b })`. The
//! changed side holds the operands as they were, since one mutant runs at a time, so that the text grows with the depth
//! of expressions and not with its power.

use std::ops::Range;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Expr, Lit, UnOp};

/// One change of the source.
#[derive(Default)]
pub struct Mutant {
    /// File, function, line of source and change: what names it in tables.
    pub key: String,
    /// Line of the file, from 1.
    pub line: usize,
    /// Stands in a constant, which the compiler evaluates.
    pub constant: bool,
    /// The rewritten code does not compile with it.
    pub dropped: bool,
}

/// Text before and after a range of the source.
pub struct Edit {
    pub range: Range<usize>,
    /// Alternatives in their order, each with its mutant.
    pub choices: Vec<(usize, String)>,
    pub kind: Kind,
}

#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// An expression with another one instead.
    Instead,
    /// A statement that may be left out.
    LeftOut,
    /// Code at the beginning of a body.
    Entry,
}

/// What was found in one file.
#[derive(Default)]
pub struct Found {
    pub mutants: Vec<Mutant>,
    pub edits: Vec<Edit>,
}

/// All mutants of a file's text; their numbers begin at `first`.
pub fn find(path: &str, text: &str, first: usize) -> Result<Found, syn::Error> {
    let tree = syn::parse_file(text)?;
    let mut finder = Finder {
        path,
        text,
        first,
        owner: String::new(),
        function: String::new(),
        constant: false,
        deferred: Vec::new(),
        found: Found::default(),
    };
    finder.visit_file(&tree);
    finder.number_repetitions();
    Ok(finder.found)
}

/// True for what is compiled for tests only.
pub fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|a| {
        a.path().is_ident("test")
            || (a.path().is_ident("cfg")
                && a.parse_args::<syn::Path>()
                    .is_ok_and(|condition| condition.is_ident("test")))
    })
}

struct Finder<'a> {
    path: &'a str,
    text: &'a str,
    first: usize,
    owner: String,
    function: String,
    constant: bool,
    /// Variables declared without a value, whose assignments cannot be left out.
    deferred: Vec<String>,
    found: Found,
}

impl Finder<'_> {
    fn source(&self, node: &impl Spanned) -> &str {
        &self.text[node.span().byte_range()]
    }

    fn number_repetitions(&mut self) {
        let mut seen = std::collections::HashMap::new();
        for mutant in &mut self.found.mutants {
            let count = seen.entry(mutant.key.clone()).or_insert(0);
            *count += 1;
            if *count > 1 {
                mutant.key = format!("{} ({count})", mutant.key);
            }
        }
    }

    fn add(&mut self, range: Range<usize>, kind: Kind, options: Vec<(String, String)>) {
        let before = &self.text[..range.start];
        let begin = before.rfind('\n').map_or(0, |i| i + 1);
        let end = self.text[range.start..]
            .find('\n')
            .map_or(self.text.len(), |i| range.start + i);
        let line = self.text[begin..end].trim();
        let mut choices = Vec::new();
        for (name, code) in options {
            choices.push((self.first + self.found.mutants.len(), code));
            self.found.mutants.push(Mutant {
                key: format!("{} {} | {line} | {name}", self.path, self.function),
                line: before.matches('\n').count() + 1,
                constant: self.constant,
                dropped: false,
            });
        }
        self.found.edits.push(Edit {
            range,
            choices,
            kind,
        });
    }

    fn instead(&mut self, node: &impl Spanned, options: Vec<(String, String)>) {
        if !options.is_empty() {
            self.add(node.span().byte_range(), Kind::Instead, options);
        }
    }

    fn binary(&mut self, e: &syn::ExprBinary) {
        if has_let(&e.left) || has_let(&e.right) {
            return;
        }
        let [left, op, right] = [
            self.source(&e.left),
            self.source(&e.op),
            self.source(&e.right),
        ];
        let sign = if is_assignment(op) { "=" } else { "" };
        let others = other_operators(op.strip_suffix(sign).unwrap_or(op)).iter();
        let option = |other: &&str| {
            let other = format!("{other}{sign}");
            let code = match sign {
                "=" => format!("{left} {other} {right}"),
                _ => format!("({left}) {other} ({right})"),
            };
            (format!("{op} -> {other}"), code)
        };
        let options = others.map(option).collect();
        self.instead(e, options);
    }

    fn literal(&mut self, e: &syn::ExprLit) {
        let option = match &e.lit {
            Lit::Bool(b) => {
                let (value, other) = (b.value, !b.value);
                Some((format!("{value} -> {other}"), other.to_string()))
            }
            Lit::Int(i) => i.base10_parse::<u128>().ok().map(|value| {
                let other = if value == 0 { 1 } else { value - 1 };
                (format!("{i} -> {other}"), format!("{other}{}", i.suffix()))
            }),
            Lit::Float(f) => Some((format!("{f} -> {f} + 1"), format!("({f} + 1.0)"))),
            _ => None,
        };
        self.instead(e, option.into_iter().collect());
    }

    fn method(&mut self, e: &syn::ExprMethodCall) {
        let name = e.method.to_string();
        let other = match name.as_str() {
            "min" => "max",
            "max" => "min",
            "wrapping_add" => "wrapping_sub",
            "wrapping_sub" => "wrapping_add",
            "saturating_add" => "saturating_sub",
            "saturating_sub" => "saturating_add",
            "wrapping_mul" => "wrapping_add",
            "saturating_mul" => "saturating_add",
            "wrapping_shl" => "wrapping_shr",
            "wrapping_shr" => "wrapping_shl",
            _ => return,
        };
        let (whole, method) = (e.span().byte_range(), e.method.span().byte_range());
        let before = &self.text[whole.start..method.start];
        let after = &self.text[method.end..whole.end];
        let code = format!("{before}{other}{after}");
        self.instead(e, vec![(format!("{name} -> {other}"), code)]);
    }

    /// A condition that is no comparison of its own.
    fn condition(&mut self, e: &Expr) {
        let plain = matches!(
            e,
            Expr::MethodCall(_) | Expr::Call(_) | Expr::Path(_) | Expr::Field(_) | Expr::Macro(_)
        );
        if plain {
            let code = format!("!({})", self.source(e));
            self.instead(e, vec![("condition -> not".into(), code)]);
        }
    }

    fn body(&mut self, name: &syn::Ident, signature: &syn::Signature, block: &syn::Block) {
        let deferred = std::mem::take(&mut self.deferred);
        let outer = (self.function.clone(), self.constant, deferred);
        self.function = if self.owner.is_empty() {
            name.to_string()
        } else {
            format!("{}::{name}", self.owner)
        };
        self.constant = false;
        let start = block.brace_token.span.open().byte_range().end;
        let results = match &signature.output {
            syn::ReturnType::Default => vec![""],
            syn::ReturnType::Type(_, kind) => default_results(self.source(&**kind)),
        };
        let option = |r: &&str| (format!("returns {r}").trim().into(), format!("return {r};"));
        if !block.stmts.is_empty() {
            let options = results.iter().map(option).collect();
            self.add(start..start, Kind::Entry, options);
        }
        visit::visit_block(self, block);
        (self.function, self.constant, self.deferred) = outer;
    }
}

impl<'ast> Visit<'ast> for Finder<'_> {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        let attributes = match item {
            syn::Item::Mod(m) => &m.attrs,
            syn::Item::Fn(f) => &f.attrs,
            syn::Item::Impl(i) => &i.attrs,
            syn::Item::Use(u) => &u.attrs,
            syn::Item::Const(c) => &c.attrs,
            _ => return visit::visit_item(self, item),
        };
        if !is_test(attributes) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_impl(&mut self, item: &'ast syn::ItemImpl) {
        let kind = self.source(&*item.self_ty);
        let name = kind.split('<').next().unwrap_or(kind).to_string();
        let outer = std::mem::replace(&mut self.owner, name);
        visit::visit_item_impl(self, item);
        self.owner = outer;
    }

    fn visit_item_trait(&mut self, item: &'ast syn::ItemTrait) {
        let outer = std::mem::replace(&mut self.owner, item.ident.to_string());
        visit::visit_item_trait(self, item);
        self.owner = outer;
    }

    fn visit_item_fn(&mut self, f: &'ast syn::ItemFn) {
        self.body(&f.sig.ident, &f.sig, &f.block);
    }

    fn visit_impl_item_fn(&mut self, f: &'ast syn::ImplItemFn) {
        if !is_test(&f.attrs) {
            self.body(&f.sig.ident, &f.sig, &f.block);
        }
    }

    fn visit_trait_item_fn(&mut self, f: &'ast syn::TraitItemFn) {
        if let Some(block) = &f.default {
            self.body(&f.sig.ident, &f.sig, block);
        }
    }

    fn visit_item_const(&mut self, c: &'ast syn::ItemConst) {
        self.constant_value(&c.ident, &c.expr);
    }

    fn visit_item_static(&mut self, c: &'ast syn::ItemStatic) {
        self.constant_value(&c.ident, &c.expr);
    }

    fn visit_impl_item_const(&mut self, c: &'ast syn::ImplItemConst) {
        self.constant_value(&c.ident, &c.expr);
    }

    fn visit_trait_item_const(&mut self, c: &'ast syn::TraitItemConst) {
        if let Some((_, value)) = &c.default {
            self.constant_value(&c.ident, value);
        }
    }

    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}
    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_generic_argument(&mut self, _: &'ast syn::GenericArgument) {}
    fn visit_generics(&mut self, _: &'ast syn::Generics) {}
    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}
    fn visit_variant(&mut self, _: &'ast syn::Variant) {}

    fn visit_expr_repeat(&mut self, e: &'ast syn::ExprRepeat) {
        self.visit_expr(&e.expr);
    }

    fn visit_local(&mut self, local: &'ast syn::Local) {
        if local.init.is_none() {
            let name = match &local.pat {
                syn::Pat::Type(t) => self.source(&*t.pat),
                other => self.source(other),
            };
            self.deferred.push(name.to_string());
        }
        visit::visit_local(self, local);
    }

    fn visit_stmt(&mut self, statement: &'ast syn::Stmt) {
        if let syn::Stmt::Expr(e, Some(_)) = statement {
            let left_out = match e {
                Expr::Assign(a) => {
                    let target = self.source(&*a.left);
                    !self.deferred.iter().any(|name| name == target)
                }
                Expr::Binary(b) => is_assignment(self.source(&b.op)),
                Expr::Call(_) | Expr::MethodCall(_) => true,
                _ => false,
            };
            if left_out {
                let option = vec![("left out".into(), String::new())];
                self.add(statement.span().byte_range(), Kind::LeftOut, option);
            }
        }
        visit::visit_stmt(self, statement);
    }

    fn visit_arm(&mut self, arm: &'ast syn::Arm) {
        if let Some((_, guard)) = &arm.guard {
            self.condition(guard);
        }
        visit::visit_arm(self, arm);
    }

    fn visit_expr(&mut self, e: &'ast Expr) {
        match e {
            Expr::Binary(b) => self.binary(b),
            Expr::Lit(l) => self.literal(l),
            Expr::MethodCall(m) => self.method(m),
            Expr::If(i) => self.condition(&i.cond),
            Expr::While(w) => self.condition(&w.cond),
            Expr::Unary(u) if matches!(u.op, UnOp::Neg(_) | UnOp::Not(_)) => {
                let code = format!("({})", self.source(&*u.expr));
                let name = format!("{} left out", self.source(&u.op));
                self.instead(u, vec![(name, code)]);
            }
            _ => {}
        }
        visit::visit_expr(self, e);
    }
}

impl Finder<'_> {
    fn constant_value(&mut self, name: &syn::Ident, value: &Expr) {
        let outer = (
            std::mem::replace(&mut self.function, name.to_string()),
            std::mem::replace(&mut self.constant, true),
        );
        self.visit_expr(value);
        (self.function, self.constant) = outer;
    }
}

fn has_let(e: &Expr) -> bool {
    match e {
        Expr::Let(_) => true,
        Expr::Binary(b) => has_let(&b.left) || has_let(&b.right),
        _ => false,
    }
}

fn is_assignment(op: &str) -> bool {
    op.ends_with('=') && !["==", "!=", "<=", ">="].contains(&op)
}

/// What may stand in place of an operator; `+=` and its like change as `+` does.
fn other_operators(op: &str) -> &'static [&'static str] {
    match op {
        "+" => &["-"],
        "-" | "*" => &["+"],
        "/" => &["*"],
        "%" => &["/"],
        "&&" => &["||"],
        "||" => &["&&"],
        "^" | "|" => &["&"],
        "&" => &["|"],
        "<<" => &[">>"],
        ">>" => &["<<"],
        "==" => &["!="],
        "!=" => &["=="],
        "<" => &["<=", ">="],
        "<=" => &["<", ">"],
        ">" => &[">=", "<="],
        ">=" => &[">", "<"],
        _ => &[],
    }
}

fn default_results(kind: &str) -> Vec<&'static str> {
    match kind {
        "bool" => vec!["true", "false"],
        "u8" | "u16" | "u32" | "u64" | "u128" | "usize" | "i8" | "i16" | "i32" | "i64" | "i128"
        | "isize" => vec!["0", "1"],
        "!" => vec![],
        _ if kind.starts_with('&') || kind.starts_with("impl") => vec![],
        _ if kind.starts_with("Option<") => vec!["None"],
        _ if kind.starts_with("Result<") => vec!["Ok(Default::default())"],
        _ => vec!["Default::default()"],
    }
}
