//! The public include as it is published: in one piece, with prefixed names, exact in any compiler, and the same in Slang.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::source::{self, words};

/// The public include in GLSL, ready for a shader of anybody's.
pub fn glsl(root: &Path, path: &str) -> Result<String> {
    Ok(precise(&source::in_one_piece(root, path)?))
}

/// The public include in Slang.
pub fn slang(root: &Path, path: &str) -> Result<String> {
    translated(&source::in_one_piece(root, path)?)
}

/// Code and comment of a line.
fn parts(line: &str) -> (&str, &str) {
    line.split_at(line.find("//").unwrap_or(line.len()))
}

/// Words and signs, without white space.
fn tokens(code: &str) -> Vec<&str> {
    words(code).map(str::trim).filter(|word| !word.is_empty()).collect()
}

/// The structures of a text, in order: name, and type and name of each field.
fn structures(text: &str) -> Vec<(&str, Vec<(&str, &str)>)> {
    let mut found: Vec<(&str, Vec<(&str, &str)>)> = Vec::new();
    let mut is_open = false;
    for line in text.lines() {
        match tokens(parts(line).0).as_slice() {
            ["struct", name, "{"] => {
                found.push((name, Vec::new()));
                is_open = true;
            }
            ["}", ";"] => is_open = false,
            [of, name, ";"] if is_open => found.iter_mut().last().into_iter().for_each(|(_, fields)| fields.push((of, name))),
            _ => {}
        }
    }
    found
}

/// The types in which floats are kept: floats, vectors of them, and the structures of a text that hold such.
fn floating(text: &str) -> BTreeSet<&str> {
    let mut found: BTreeSet<&str> = ["float", "vec2", "vec3", "vec4"].into();
    for (name, fields) in structures(text) {
        if fields.iter().any(|(of, _)| found.contains(of)) {
            found.insert(name);
        }
    }
    found
}

/// Whether a line outside of all braces begins the definition of a function.
fn begins_function(code: &str) -> bool {
    matches!(tokens(code).as_slice(), [first, _, "(", ..] if !["#", "struct", "const", "layout"].contains(first))
}

/// Declares every variable, result and output that holds floats `precise`, so that a compiler contracts nothing: it must be said in each
/// function, since compilers do not carry it from one into another.
fn precise(text: &str) -> String {
    let floating = floating(text);
    let mut out = String::with_capacity(text.len() + text.len() / 16);
    let (mut depth, mut in_function) = (0_usize, false);
    for line in text.lines() {
        let (code, comment) = parts(line);
        if depth == 0 {
            in_function = begins_function(code);
        }
        let header = depth == 0;
        let pieces: Vec<&str> = words(code).collect();
        let significant = |at: usize| pieces.get(at..).unwrap_or_default().iter().copied().find(|piece| !piece.trim().is_empty());
        let mut before = "";
        for (at, piece) in pieces.iter().enumerate() {
            let name_at = at + 1 + pieces[at + 1..].iter().take_while(|piece| piece.trim().is_empty()).count();
            let after = significant(name_at + 1).unwrap_or_default();
            let declares = match before {
                // A result, or the declaration of a variable.
                "" | "{" | ";" | "(" => floating.contains(*piece) && (["=", ";"].contains(&after) || (header && before.is_empty())),
                _ => false,
            };
            // An output, whose type follows.
            let outputs = header && ["out", "inout"].contains(piece) && significant(name_at).is_some_and(|of| floating.contains(of));
            if in_function && (declares || outputs) {
                out.push_str("precise ");
            }
            out.push_str(piece);
            if !piece.trim().is_empty() {
                before = piece;
            }
        }
        out.push_str(comment);
        out.push('\n');
        depth = (depth + code.matches('{').count()).saturating_sub(code.matches('}').count());
    }
    out
}

/// GLSL's names, and Slang's.
const WORDS: [(&str, &str); 22] = [
    ("vec2", "float2"),
    ("vec3", "float3"),
    ("vec4", "float4"),
    ("uvec2", "uint2"),
    ("uvec3", "uint3"),
    ("uvec4", "uint4"),
    ("ivec2", "int2"),
    ("ivec3", "int3"),
    ("ivec4", "int4"),
    ("bvec2", "bool2"),
    ("bvec3", "bool3"),
    ("bvec4", "bool4"),
    ("floatBitsToUint", "asuint"),
    ("uintBitsToFloat", "asfloat"),
    ("floatBitsToInt", "asint"),
    ("intBitsToFloat", "asfloat"),
    ("mix", "lerp"),
    ("fract", "frac"),
    ("inversesqrt", "rsqrt"),
    ("bitCount", "countbits"),
    ("findLSB", "firstbitlow"),
    ("findMSB", "firstbithigh"),
];

/// GLSL's comparisons of vectors, and Slang's operators.
const COMPARISONS: [(&str, &str); 6] =
    [("lessThan", "<"), ("lessThanEqual", "<="), ("greaterThan", ">"), ("greaterThanEqual", ">="), ("equal", "=="), ("notEqual", "!=")];

const SLANG_HEAD: &str = "\
// gridwalk in your own Slang shader: include this file. It is gridwalk.glsl in Slang, under the same names; what follows documents it.
// Compile with -fp-mode precise: without that a compiler may contract products and sums, and rays may pass between triangles that share an
// edge. Of SPIR-V it needs 1.5 and physical storage buffers, no 64-bit integers.
//
//   #include \"gridwalk.slang\"
//   Hit hit = gridwalk_closest_hit(GridwalkGrid(grid_address), Ray(origin, t_min, direction, t_max)); // grid_address: uint2
//
";

/// The one-piece GLSL in Slang: what differs are names of types and functions, comparisons of vectors, and references to buffers, which
/// become pointers.
fn translated(text: &str) -> Result<String> {
    let mut out = String::from(SLANG_HEAD);
    let structures = structures(text);
    let (mut depth, mut guarded) = (0_usize, false);
    for line in text.lines() {
        let (code, comment) = parts(line);
        if comment.contains("#extension") || comment.contains("#include") {
            continue;
        }
        let comment = comment.replace("gridwalk.glsl", "gridwalk.slang");
        let mut code = match buffer(code, &structures).with_context(|| line.to_owned())? {
            Some(pointer) => pointer,
            None => code.to_owned(),
        };
        for (name, operator) in COMPARISONS {
            code = infix(&code, name, operator).with_context(|| line.to_owned())?;
        }
        if depth == 0 && code.starts_with("const ") {
            code.insert_str(0, "static ");
        }
        for word in words(&code) {
            out.push_str(WORDS.iter().find(|(name, _)| *name == word).map_or(word, |(_, slang)| slang));
        }
        out.push_str(&comment);
        out.push('\n');
        if !guarded && code.starts_with("#define") {
            // Slang wants every path of a function to set its outputs, also those on which it says that they mean nothing.
            out.push_str("#pragma warning(push)\n#pragma warning(disable : 41018)\n");
            guarded = true;
        }
        depth = (depth + code.matches('{').count()).saturating_sub(code.matches('}').count());
    }
    let end = out.rfind("#endif").context("no include guard")?;
    out.insert_str(end, "#pragma warning(pop)\n\n");
    Ok(out.replace("GRIDWALK_GLSL", "GRIDWALK_SLANG"))
}

/// A reference to a buffer as a structure with a pointer, made of an address. Structures are read field by field: Mesa does not take
/// modules of Slang's that load them whole.
fn buffer(code: &str, structures: &[(&str, Vec<(&str, &str)>)]) -> Result<Option<String>> {
    if !code.starts_with("layout") {
        return Ok(None);
    }
    let Some((_, declared)) = code.split_once(" buffer ") else { bail!("no buffer") };
    let declared = tokens(declared);
    let ([name, "{", of, field, "[", "]", ";", "}", ";"] | [name, "{", of, field, ";", "}", ";"]) = declared[..] else {
        bail!("a buffer of more than one member")
    };
    let is_array = declared.contains(&"[");
    let fields = structures.iter().find(|(structure, _)| *structure == of).map(|(_, fields)| fields);
    let init = |pointer: &str| format!("__init(uvec2 address) {{ {pointer} = bit_cast<{of}*>(address); }}");
    let read = |from: &str| {
        let copies: String = fields.into_iter().flatten().map(|(_, field)| format!(" value.{field} = {from}{field};")).collect();
        format!("get {{ {of} value;{copies} return value; }}")
    };
    Ok(Some(match (fields, is_array) {
        (None, true) => format!("struct {name} {{\n    {of}* {field};\n    {}\n}};", init(field)),
        (None, false) => bail!("a buffer of a single value"),
        (Some(_), true) => format!(
            "struct {name}Elements {{\n    {of}* pointer;\n    __subscript(uint i) -> {of} {{\n        {}\n    }}\n}};\n\
            struct {name} {{\n    {name}Elements {field};\n    {}\n}};",
            read("pointer[i]."),
            init(&format!("{field}.pointer"))
        ),
        (Some(_), false) => format!(
            "struct {name} {{\n    {of}* pointer;\n    {}\n    property {of} {field} {{\n        {}\n    }}\n}};",
            init("pointer"),
            read("pointer->")
        ),
    }))
}

/// Calls `name(a, b)` as `(a operator b)`.
fn infix(code: &str, name: &str, operator: &str) -> Result<String> {
    let mut out = code.to_owned();
    let call = format!("{name}(");
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    while let Some(at) = out.match_indices(&call).map(|(at, _)| at).find(|at| !out[..*at].ends_with(is_word)) {
        let (mut depth, mut comma, mut end) = (0, None, None);
        for (offset, c) in out[at + name.len()..].char_indices() {
            match c {
                '(' => depth += 1,
                ')' => depth -= 1,
                ',' if depth == 1 => comma = Some(at + name.len() + offset),
                _ => {}
            }
            if depth == 0 {
                end = Some(at + name.len() + offset);
                break;
            }
        }
        let (Some(comma), Some(end)) = (comma, end) else { bail!("{name}: not on one line") };
        let (left, right) = (&out[at + call.len()..comma], out[comma + 1..end].trim());
        out = format!("{}({left} {operator} {right}){}", &out[..at], &out[end + 1..]);
    }
    Ok(out)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    const TEXT: &str = "#ifndef A\n#define A\n// #include \"gridwalk.glsl\"\n// gridwalk.glsl\nconst float B = 1.0;\nstruct S {\n    vec3 at;\n};\n\
        struct T {\n    uint n;\n};\nlayout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer R { uvec2 of[]; };\n\
        layout(buffer_reference) readonly buffer G { S header; };\nlayout(buffer_reference) readonly buffer E { S all[]; };\n\
        S f(vec3 a, inout S s, out uint n) {\n    float x = a.x * B; // float y = 1\n    T t;\n    for (float i = 0.0; i < 1.0; i += x) {}\n    \
        n = any(lessThan(a, vec3(x, 0.0, 0.0))) ? R(t).of[0].x : 0u;\n    return s;\n}\n#endif\n";

    #[test]
    fn floats_are_precise() {
        let out = precise(TEXT);
        for expected in [
            "\nconst float B = 1.0;",
            "\n    vec3 at;",
            "\nprecise S f(vec3 a, precise inout S s, out uint n) {",
            "\n    precise float x = a.x * B; // float y = 1",
            "\n    T t;",
            "for (precise float i = 0.0;",
        ] {
            assert!(out.contains(expected), "{expected}\n{out}");
        }
    }

    #[test]
    fn slang_is_made() {
        let out = translated(TEXT).unwrap();
        for expected in [
            "// gridwalk.slang\nstatic const float B = 1.0;",
            "struct R {\n    uint2* of;\n    __init(uint2 address) { of = bit_cast<uint2*>(address); }\n};",
            "    property S header {\n        get { S value; value.at = pointer->at; return value; }\n    }\n",
            "    __subscript(uint i) -> S {\n        get { S value; value.at = pointer[i].at; return value; }\n    }\n",
            "struct E {\n    EElements all;\n    __init(uint2 address) { all.pointer = bit_cast<S*>(address); }\n};",
            "n = any((a < float3(x, 0.0, 0.0))) ? R(t).of[0].x : 0u;",
            "#pragma warning(pop)\n\n#endif",
        ] {
            assert!(out.contains(expected), "{expected}\n{out}");
        }
        assert!(translated("layout(local_size_x = 1) in;\n").is_err());
        assert!(translated("bvec3 b = lessThan(a,\n").is_err());
    }
}
