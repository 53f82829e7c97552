//! A barrier that only some invocations of a workgroup reach hangs or corrupts, and on a CPU driver often neither shows. This looks, in the
//! source, for a barrier in flow that may differ between the invocations of a workgroup.
//!
//! A value counts as varying if it comes from an invocation's own index, is assigned from something varying, or is assigned in varying flow;
//! a function counts as varying if its body mentions something of the kind. Parameters and memory count as uniform unless they are assigned
//! or indexed by something varying, so that this finds mistakes rather than proves that there are none.

use std::collections::{BTreeMap, BTreeSet};

/// A word or a sign of GLSL.
#[derive(Clone, Debug, PartialEq)]
pub enum Token {
    /// An identifier, a keyword or a number.
    Word(String),
    /// Any other character.
    Sign(char),
}

/// The tokens of a source, without comments and without lines of the preprocessor.
pub fn tokens(source: &str) -> Vec<Token> {
    let mut text = String::new();
    let mut rest = source;
    while let Some(at) = rest.find("/*") {
        // A line comment may hold the beginning of a block comment.
        let line = &rest[..at];
        if line.rsplit('\n').next().is_some_and(|line| line.contains("//")) {
            let end = rest[at..].find('\n').map_or(rest.len(), |end| at + end);
            text += &rest[..end];
            rest = &rest[end..];
        } else {
            text += line;
            text.push(' ');
            rest = rest[at..].find("*/").map_or("", |end| &rest[at + end + 2..]);
        }
    }
    text += rest;
    let mut out = Vec::new();
    let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    for line in code.filter(|line| !line.trim_start().starts_with('#')) {
        let mut word = String::new();
        for c in line.chars().chain([' ']) {
            if c.is_alphanumeric() || c == '_' {
                word.push(c);
                continue;
            }
            if !word.is_empty() {
                out.push(Token::Word(std::mem::take(&mut word)));
            }
            if !c.is_whitespace() {
                out.push(Token::Sign(c));
            }
        }
    }
    out
}

enum Statement {
    Block(Vec<Statement>),
    /// `if`, `switch`
    Branch(Vec<Token>, Vec<Statement>),
    /// `for`, `while`, `do`
    Loop(Vec<Token>, Box<Statement>),
    Simple(Vec<Token>),
}

fn is(token: Option<&Token>, wanted: &str) -> bool {
    match token {
        Some(Token::Word(word)) => word == wanted,
        Some(Token::Sign(sign)) => wanted.len() == 1 && wanted.starts_with(*sign),
        None => false,
    }
}

/// The tokens between the bracket at `at` and its partner; `at` moves behind it.
fn bracketed(tokens: &[Token], at: &mut usize) -> Vec<Token> {
    let start = *at + 1;
    let mut depth = 0;
    while let Some(token) = tokens.get(*at) {
        *at += 1;
        match token {
            Token::Sign('(' | '{' | '[') => depth += 1,
            Token::Sign(')' | '}' | ']') => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return tokens[start..*at - 1].to_vec();
        }
    }
    panic!("a bracket is not closed");
}

fn statements(tokens: &[Token]) -> Vec<Statement> {
    let mut at = 0;
    let mut all = Vec::new();
    while at < tokens.len() {
        all.push(statement(tokens, &mut at));
    }
    all
}

fn statement(tokens: &[Token], at: &mut usize) -> Statement {
    let first = tokens.get(*at);
    if is(first, "{") {
        return Statement::Block(statements(&bracketed(tokens, at)));
    }
    for keyword in ["if", "switch", "for", "while"] {
        if is(first, keyword) {
            *at += 1;
            let head = bracketed(tokens, at);
            let mut bodies = vec![statement(tokens, at)];
            if keyword == "if" && is(tokens.get(*at), "else") {
                *at += 1;
                bodies.push(statement(tokens, at));
            }
            return match keyword {
                "if" | "switch" => Statement::Branch(head, bodies),
                _ => Statement::Loop(head, Box::new(Statement::Block(bodies))),
            };
        }
    }
    if is(first, "do") {
        *at += 1;
        let body = statement(tokens, at);
        *at += 1;
        let head = bracketed(tokens, at);
        return Statement::Loop(head, Box::new(body));
    }
    let start = *at;
    while *at < tokens.len() && !is(tokens.get(*at), ";") {
        *at += 1;
    }
    let simple = tokens[start..*at].to_vec();
    *at += 1;
    Statement::Simple(simple)
}

/// The bodies of all functions, by name; overloads run together.
fn functions(tokens: &[Token]) -> BTreeMap<String, Vec<Token>> {
    let mut found: BTreeMap<String, Vec<Token>> = BTreeMap::new();
    let mut at = 0;
    while at < tokens.len() {
        let name = match &tokens[at..] {
            [Token::Word(_), Token::Word(name), Token::Sign('('), ..] => Some(name.clone()),
            _ => None,
        };
        if let Some(name) = name {
            at += 2;
            bracketed(tokens, &mut at);
            if is(tokens.get(at), "{") {
                found.entry(name).or_default().extend(bracketed(tokens, &mut at));
            }
        } else if is(tokens.get(at), "{") || is(tokens.get(at), "(") {
            bracketed(tokens, &mut at);
        } else {
            at += 1;
        }
    }
    found
}

fn words(tokens: &[Token]) -> impl Iterator<Item = &str> {
    tokens.iter().filter_map(|token| match token {
        Token::Word(word) => Some(word.as_str()),
        Token::Sign(_) => None,
    })
}

/// Names of functions from which one in `seeds` is reached.
fn reaching(functions: &BTreeMap<String, Vec<Token>>, seeds: &[&str]) -> BTreeSet<String> {
    let mut reached: BTreeSet<String> = seeds.iter().map(|&seed| seed.to_owned()).collect();
    loop {
        let before = reached.len();
        for (name, body) in functions {
            if words(body).any(|word| reached.contains(word)) {
                reached.insert(name.clone());
            }
        }
        if reached.len() == before {
            return reached;
        }
    }
}

struct Check<'a> {
    function: &'a str,
    /// Functions that hold a barrier, and `barrier` itself.
    barriers: &'a BTreeSet<String>,
    varying: BTreeSet<String>,
    violations: BTreeSet<String>,
    /// A `return` in varying flow came before.
    left: bool,
}

/// Every barrier, direct or in a called function, that stands in varying flow. Empty when all is well.
pub fn violations(source: &str) -> Vec<String> {
    let functions = functions(&tokens(source));
    let own = ["gl_LocalInvocationID", "gl_LocalInvocationIndex", "gl_GlobalInvocationID", "gl_SubgroupInvocationID", "gl_SubgroupID"];
    let varying = reaching(&functions, &own);
    let barriers = reaching(&functions, &["barrier"]);
    let mut all = Vec::new();
    for (name, body) in &functions {
        let body = statements(body);
        let mut check = Check { function: name, barriers: &barriers, varying: varying.clone(), violations: BTreeSet::new(), left: false };
        // What varies is known only when nothing more is found: loops carry values from their end to their beginning.
        loop {
            let before = check.varying.len();
            (check.violations, check.left) = (BTreeSet::new(), false);
            for statement in &body {
                check.walk(statement, false, false);
            }
            if check.varying.len() == before {
                break;
            }
        }
        all.extend(check.violations);
    }
    all
}

impl Check<'_> {
    fn varies(&self, tokens: &[Token]) -> bool {
        words(tokens).any(|word| self.varying.contains(word))
    }

    fn holds_barrier(&self, statement: &Statement) -> bool {
        match statement {
            Statement::Block(all) => all.iter().any(|s| self.holds_barrier(s)),
            Statement::Branch(head, all) => self.calls_barrier(head) || all.iter().any(|s| self.holds_barrier(s)),
            Statement::Loop(head, body) => self.calls_barrier(head) || self.holds_barrier(body),
            Statement::Simple(tokens) => self.calls_barrier(tokens),
        }
    }

    fn calls_barrier(&self, tokens: &[Token]) -> bool {
        words(tokens).any(|word| self.barriers.contains(word))
    }

    /// `divergent`: not all invocations may come here; `looped`: the innermost loop around holds a barrier.
    fn walk(&mut self, statement: &Statement, divergent: bool, looped: bool) {
        match statement {
            Statement::Block(all) => all.iter().for_each(|s| self.walk(s, divergent, looped)),
            Statement::Branch(head, all) => {
                self.simple(head, divergent, looped);
                let divergent = divergent || self.varies(head);
                all.iter().for_each(|s| self.walk(s, divergent, looped));
            }
            Statement::Loop(head, body) => {
                head.split(|token| *token == Token::Sign(';')).for_each(|part| self.simple(part, divergent, looped));
                let divergent = divergent || self.varies(head);
                let looped = self.holds_barrier(body);
                self.walk(body, divergent, looped);
            }
            Statement::Simple(tokens) => self.simple(tokens, divergent, looped),
        }
    }

    fn simple(&mut self, tokens: &[Token], divergent: bool, looped: bool) {
        if self.calls_barrier(tokens) && (divergent || self.left) {
            let why = if divergent { "stands in flow" } else { "comes after a return in flow" };
            self.violations.insert(format!("{}: a barrier {why} that may differ between invocations", self.function));
        }
        let leaves = |keyword| words(tokens).any(|word| word == keyword);
        if divergent && leaves("return") {
            self.left = true;
        }
        if divergent && looped && (leaves("break") || leaves("continue")) {
            self.violations.insert(format!("{}: a loop with a barrier is left in flow that may differ", self.function));
        }
        self.assign(tokens, divergent);
    }

    fn assign(&mut self, tokens: &[Token], divergent: bool) {
        let comparison = |i: usize| {
            tokens.get(i + 1) == Some(&Token::Sign('=')) || (i > 0 && matches!(tokens[i - 1], Token::Sign('=' | '<' | '>' | '!')))
        };
        let Some(at) = (0..tokens.len()).find(|&i| tokens[i] == Token::Sign('=') && !comparison(i)) else { return };
        let (target, value) = tokens.split_at(at);
        if divergent || self.varies(value) || self.varies(target) {
            // `type name =` declares, anything else begins with the name.
            let name = match target {
                [Token::Word(_), Token::Word(name), ..] => Some(name),
                [Token::Word(name), ..] => Some(name),
                _ => None,
            };
            self.varying.extend(name.cloned());
        }
    }
}

#[test]
fn uniform_flow_is_accepted() {
    let source = "
        shared uint sum[64]; // a /* in a comment
        uint group() { return gl_WorkGroupID.x; }
        uint scan(uint mine) {
            uint lane = gl_LocalInvocationID.x;
            sum[lane] = mine;
            barrier();
            for (uint reach = 1u; reach < 64u; reach *= 2u) { uint a = lane >= reach ? sum[lane - reach] : 0u; barrier(); sum[lane] += a; barrier(); }
            return sum[lane];
        }
        void main() {
            if (group() >= count) return;
            for (uint i = 0u; i < count; i += 64u) { if (gl_LocalInvocationID.x == i) { x[i] = 1u; } scan(i + gl_LocalInvocationID.x); }
            if (gl_LocalInvocationID.x == 0u) { out.word[0] = 1u; return; }
        }";
    assert_eq!(violations(source), [""; 0]);
}

#[test]
fn divergent_flow_is_found() {
    for body in [
        "if (gl_LocalInvocationID.x < 3u) { barrier(); }",
        "uint lane = gl_LocalInvocationID.x; uint next = lane + 1u; if (next < 3u) barrier();",
        "uint n = 0u; if (lane() == 0u) n = 1u; for (uint i = 0u; i < n; ++i) barrier();",
        "if (lane() > count) { return; } barrier();",
        "for (uint i = 0u; i < 4u; ++i) { if (lane() == i) break; barrier(); }",
        "for (uint i = lane(); i < 4u; ++i) { scan(); }",
        "uint last = 4u; for (uint i = 0u; i < 4u; ++i) { if (last > 2u) { barrier(); } last = lane(); }",
        "while (true) { if (lane() == 3u) continue; scan(); }",
    ] {
        let source = format!("uint lane() {{ return gl_LocalInvocationID.x; }} void scan() {{ barrier(); }} void main() {{ {body} }}");
        assert_eq!(violations(&source).len(), 1, "{body}");
    }
}
