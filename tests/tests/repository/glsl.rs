//! What a kernel may hold, by the folder that it lies in. The thesis splits its kernels into those that work on elements alone and those in
//! which invocations exchange data; the folders hold that split, and these tests keep it.

use gridwalk_shaders::source::{self, KernelSource, OWNERS};

use super::divergence::{self, Token};
use super::root;

fn kernels(kind: &str) -> Vec<KernelSource> {
    let all = OWNERS.iter().flat_map(|owner| owner.kernels(&root()).unwrap());
    let kernels: Vec<KernelSource> = all.filter(|kernel| kernel.kind == kind).collect();
    assert!(!kernels.is_empty(), "no {kind} kernel found");
    kernels
}

/// What no map kernel may hold, or include.
fn exchange(source: &str) -> Vec<String> {
    let forbidden = |word: &str| {
        ["shared", "barrier"].contains(&word)
            || ["atomic", "subgroup", "gl_Subgroup", "memoryBarrier", "groupMemoryBarrier", "imageAtomic"]
                .iter()
                .any(|start| word.starts_with(start))
    };
    let words = divergence::tokens(source).into_iter().filter_map(|token| match token {
        Token::Word(word) => Some(word),
        Token::Sign(_) => None,
    });
    words.filter(|word| forbidden(word)).collect()
}

#[test]
fn map_kernels_exchange_nothing() {
    for kernel in kernels("map") {
        for (path, text) in source::closure(&root(), &kernel.path).unwrap() {
            assert_eq!(
                exchange(&text),
                [""; 0],
                "{path}, part of the map kernel {}: kernels that exchange data are cooperative",
                kernel.name
            );
        }
    }
}

#[test]
fn an_exchange_would_be_seen() {
    for (text, seen) in [
        ("shared uint x[64];", "shared"),
        ("void main() { barrier(); }", "barrier"),
        ("void main() { memoryBarrierShared(); }", "memoryBarrierShared"),
        ("void main() { x = subgroupAdd(x); }", "subgroupAdd"),
        ("void main() { atomicAdd(a.x, 1u); }", "atomicAdd"),
        ("void main() { x = gl_SubgroupSize; }", "gl_SubgroupSize"),
    ] {
        assert_eq!(exchange(text), [seen]);
    }
    assert_eq!(exchange("#include \"shared/a.glsl\"\n// barrier()\n/* shared */ uint barriers;"), [""; 0]);
}

#[test]
fn barriers_stand_in_uniform_flow() {
    for kernel in kernels("cooperative") {
        let all: String = source::closure(&root(), &kernel.path).unwrap().into_values().collect();
        assert_eq!(divergence::violations(&all), [""; 0], "{}", kernel.path);
    }
}
