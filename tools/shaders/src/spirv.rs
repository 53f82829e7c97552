//! What is done to a compiled module, and what is read out of it.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use anyhow::{Context, Result, bail};
use rspirv::binary::Assemble;
use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{BuiltIn, Capability, Decoration, ExecutionMode, Op, StorageClass};

/// A finished module and what reflection found in it.
#[derive(Debug)]
pub struct Reflected {
    /// The module, as it is committed.
    pub words: Vec<u32>,
    /// Invocations a workgroup, as declared.
    pub local_size: [u32; 3],
    /// Specialization constants that override `local_size`.
    pub local_size_ids: [Option<u32>; 3],
    /// The push-constant block, if there is one.
    pub push: Option<Layout>,
    /// Buffer references of the push-constant block: member name, may read, may write.
    pub accesses: Vec<(String, bool, bool)>,
    /// Specialization constants but those of `local_size`: identifier, name, default bits.
    pub spec_constants: Vec<(u32, String, u32)>,
    /// Every structure and block with a layout in memory, by name.
    pub layouts: BTreeMap<String, Layout>,
}

/// The layout of a structure or block in memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layout {
    /// Its name in GLSL.
    pub name: String,
    /// Members with a fixed size, in order.
    pub members: Vec<Member>,
    /// Bytes up to the end of the last member of fixed size.
    pub end: u32,
    /// Bytes from one to the next where it is the element of an array.
    pub stride: Option<u32>,
}

/// A member of a [`Layout`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Member {
    /// Its name in GLSL.
    pub name: String,
    /// Bytes from the beginning.
    pub offset: u32,
    /// Bytes.
    pub size: u32,
    /// Whether it is a buffer reference or holds one, which aligns it to 8 bytes on the host.
    pub reference: bool,
}

/// Capabilities that not every device of the target has; SwiftShader has none of them.
const FORBIDDEN: [Capability; 8] = [
    Capability::Int64,
    Capability::Float64,
    Capability::Int16,
    Capability::Float16,
    Capability::Int8,
    Capability::Int64Atomics,
    Capability::StorageBuffer16BitAccess,
    Capability::StorageBuffer8BitAccess,
];

/// Floating-point arithmetic: the instructions that a driver may contract (specification, "Arithmetic Instructions").
const ARITHMETIC: [Op; 14] = [
    Op::FNegate,
    Op::FAdd,
    Op::FSub,
    Op::FMul,
    Op::FDiv,
    Op::FRem,
    Op::FMod,
    Op::Dot,
    Op::VectorTimesScalar,
    Op::MatrixTimesScalar,
    Op::VectorTimesMatrix,
    Op::MatrixTimesVector,
    Op::MatrixTimesMatrix,
    Op::OuterProduct,
];

/// Finishes a module as the compiler left it, and reflects it.
pub fn finish(words: &[u32]) -> Result<Reflected> {
    let mut module = rspirv::dr::load_words(words).map_err(|state| anyhow::anyhow!("SPIR-V not understood: {state}"))?;
    for instruction in &module.capabilities {
        if let Some(Operand::Capability(capability)) = instruction.operands.first()
            && FORBIDDEN.contains(capability)
        {
            bail!("declares the capability {capability:?}, which the target devices lack");
        }
    }
    module.debug_string_source.clear();
    module.debug_module_processed.clear();
    forbid_contraction(&mut module);
    let words = module.assemble();
    if let Some(op) = opcodes(&words).find(|&op| op == Op::Line as u32 || op == Op::NoLine as u32) {
        bail!("holds line information (opcode {op})");
    }
    reflect(&module, words)
}

/// The opcodes of a module, in order.
fn opcodes(words: &[u32]) -> impl Iterator<Item = u32> {
    let mut at = 5;
    std::iter::from_fn(move || {
        let word = *words.get(at)?;
        at += ((word >> 16) as usize).max(1);
        Some(word & 0xFFFF)
    })
}

/// Puts NoContraction on every result of floating-point arithmetic. glslang carries `precise` neither into called functions nor through
/// parameters, and a contracted operation shows on no CPU driver, so that nothing is left to the source.
fn forbid_contraction(module: &mut Module) {
    let mut done: BTreeSet<u32> = module
        .annotations
        .iter()
        .filter(|i| i.class.opcode == Op::Decorate && i.operands.get(1) == Some(&Operand::Decoration(Decoration::NoContraction)))
        .filter_map(|i| id(i, 0))
        .collect();
    let mut added = Vec::new();
    for instruction in module.functions.iter().flat_map(|f| &f.blocks).flat_map(|b| &b.instructions) {
        let contractible = ARITHMETIC.contains(&instruction.class.opcode);
        if contractible && let Some(result) = instruction.result_id.filter(|&result| done.insert(result)) {
            let operands = vec![Operand::IdRef(result), Operand::Decoration(Decoration::NoContraction)];
            added.push(Instruction::new(Op::Decorate, None, None, operands));
        }
    }
    module.annotations.extend(added);
}

fn id(instruction: &Instruction, operand: usize) -> Option<u32> {
    instruction.operands.get(operand).and_then(Operand::id_ref_any)
}

fn literal(instruction: &Instruction, operand: usize) -> Option<u32> {
    match instruction.operands.get(operand) {
        Some(&Operand::LiteralBit32(value)) => Some(value),
        _ => None,
    }
}

/// The global tables of a module by identifier.
struct Tables<'a> {
    globals: HashMap<u32, &'a Instruction>,
    names: HashMap<u32, &'a str>,
    member_names: HashMap<(u32, u32), &'a str>,
    decorations: HashMap<u32, Vec<&'a [Operand]>>,
    member_decorations: HashMap<(u32, u32), Vec<&'a [Operand]>>,
}

impl<'a> Tables<'a> {
    fn new(module: &'a Module) -> Self {
        let mut tables = Tables {
            globals: module.types_global_values.iter().filter_map(|i| Some((i.result_id?, i))).collect(),
            names: HashMap::new(),
            member_names: HashMap::new(),
            decorations: HashMap::new(),
            member_decorations: HashMap::new(),
        };
        for i in &module.debug_names {
            match (i.class.opcode, i.operands.as_slice()) {
                (Op::Name, [Operand::IdRef(target), Operand::LiteralString(name)]) => {
                    tables.names.insert(*target, name.as_str());
                }
                (Op::MemberName, [Operand::IdRef(target), Operand::LiteralBit32(member), Operand::LiteralString(name)]) => {
                    tables.member_names.insert((*target, *member), name.as_str());
                }
                _ => {}
            }
        }
        for i in &module.annotations {
            match (i.class.opcode, i.operands.as_slice()) {
                (Op::Decorate, [Operand::IdRef(target), rest @ ..]) => tables.decorations.entry(*target).or_default().push(rest),
                (Op::MemberDecorate, [Operand::IdRef(target), Operand::LiteralBit32(member), rest @ ..]) => {
                    tables.member_decorations.entry((*target, *member)).or_default().push(rest);
                }
                _ => {}
            }
        }
        tables
    }

    fn global(&self, target: u32) -> Result<&'a Instruction> {
        self.globals.get(&target).copied().with_context(|| format!("identifier {target} is not declared"))
    }

    fn decoration(&self, target: u32, wanted: Decoration) -> Option<u32> {
        number_of(self.decorations.get(&target)?, wanted)
    }

    fn member_decoration(&self, target: u32, member: u32, wanted: Decoration) -> Option<u32> {
        number_of(self.member_decorations.get(&(target, member))?, wanted)
    }

    fn has_member_decoration(&self, target: u32, member: u32, wanted: Decoration) -> bool {
        self.member_decorations.get(&(target, member)).is_some_and(|all| all.iter().any(|d| d[0] == Operand::Decoration(wanted)))
    }

    /// The structure behind a type that is a buffer reference.
    fn referenced(&self, target: u32) -> Result<Option<u32>> {
        let ty = self.global(target)?;
        let reference =
            ty.class.opcode == Op::TypePointer && ty.operands.first() == Some(&Operand::StorageClass(StorageClass::PhysicalStorageBuffer));
        Ok(if reference { id(ty, 1) } else { None })
    }

    /// Bytes of a type in memory, and whether it holds a buffer reference; `None` for a runtime array.
    fn size(&self, target: u32, matrix_stride: Option<u32>) -> Result<Option<(u32, bool)>> {
        let ty = self.global(target)?;
        Ok(match ty.class.opcode {
            Op::TypeInt | Op::TypeFloat => literal(ty, 0).map(|bits| (bits / 8, false)),
            Op::TypeVector => {
                let component = id(ty, 0).context("vector without component type")?;
                let (size, _) = self.size(component, None)?.context("vector of unknown size")?;
                Some((size * literal(ty, 1).unwrap_or(0), false))
            }
            Op::TypeMatrix => Some((matrix_stride.context("matrix without stride")? * literal(ty, 1).unwrap_or(0), false)),
            Op::TypeArray => {
                let element = id(ty, 0).context("array without element type")?;
                let length = self.global(id(ty, 1).context("array without length")?)?;
                let length = literal(length, 0).context("array of unknown length")?;
                let stride = self.decoration(target, Decoration::ArrayStride).context("array without stride")?;
                let reference = self.size(element, matrix_stride)?.is_some_and(|(_, reference)| reference);
                Some((stride.checked_mul(length).context("array too large")?, reference))
            }
            Op::TypeRuntimeArray => None,
            Op::TypePointer => Some((8, true)),
            Op::TypeStruct => {
                let layout = self.layout(target)?.context("structure without layout")?;
                let reference = layout.members.iter().any(|m| m.reference);
                let align = if reference { 8 } else { 4 };
                Some((layout.end.next_multiple_of(align), reference))
            }
            other => bail!("a member of type {other:?} has no layout"),
        })
    }

    /// The layout of a structure, if it has one.
    fn layout(&self, target: u32) -> Result<Option<Layout>> {
        let ty = self.global(target)?;
        let name = self.names.get(&target).copied().unwrap_or_default().to_owned();
        let mut layout = Layout { name, members: Vec::new(), end: 0, stride: None };
        for (index, operand) in (0..).zip(&ty.operands) {
            let Some(offset) = self.member_decoration(target, index, Decoration::Offset) else { return Ok(None) };
            let member = operand.id_ref_any().context("structure member without type")?;
            let stride = self.member_decoration(target, index, Decoration::MatrixStride);
            if let Some((size, reference)) = self.size(member, stride)? {
                let name = self.member_names.get(&(target, index)).copied().unwrap_or_default().to_owned();
                layout.end = layout.end.max(offset + size);
                layout.members.push(Member { name, offset, size, reference });
            }
        }
        Ok(Some(layout))
    }
}

fn number_of(decorations: &[&[Operand]], wanted: Decoration) -> Option<u32> {
    decorations.iter().find(|d| d[0] == Operand::Decoration(wanted)).and_then(|d| match d.get(1) {
        Some(&Operand::LiteralBit32(value)) => Some(value),
        _ => None,
    })
}

fn reflect(module: &Module, words: Vec<u32>) -> Result<Reflected> {
    let tables = Tables::new(module);
    let (local_size, local_size_ids) = local_size(module, &tables)?;
    let (push, accesses) = push_constants(module, &tables)?;
    let mut spec_constants = Vec::new();
    for i in &module.types_global_values {
        let Some(result) = i.result_id else { continue };
        let Some(spec_id) = tables.decoration(result, Decoration::SpecId) else { continue };
        if local_size_ids.contains(&Some(spec_id)) {
            continue;
        }
        let bits = match i.class.opcode {
            Op::SpecConstantTrue => 1,
            Op::SpecConstantFalse => 0,
            _ => literal(i, 0).with_context(|| format!("specialization constant {spec_id} is no 32-bit number"))?,
        };
        let name = tables.names.get(&result).copied().unwrap_or_default();
        spec_constants.push((spec_id, name.to_owned(), bits));
    }
    spec_constants.sort();
    Ok(Reflected { words, local_size, local_size_ids, push, accesses, spec_constants, layouts: layouts(module, &tables)? })
}

fn local_size(module: &Module, tables: &Tables) -> Result<([u32; 3], [Option<u32>; 3])> {
    if module.execution_modes.iter().any(|i| i.operands.contains(&Operand::ExecutionMode(ExecutionMode::LocalSizeId))) {
        bail!("declares LocalSizeId, which needs maintenance4");
    }
    let mode = module
        .execution_modes
        .iter()
        .find(|i| i.operands.get(1) == Some(&Operand::ExecutionMode(ExecutionMode::LocalSize)))
        .context("declares no workgroup size")?;
    let mut size = [1; 3];
    let mut ids = [None; 3];
    for (axis, size) in size.iter_mut().enumerate() {
        *size = literal(mode, 2 + axis).context("workgroup size of unknown form")?;
    }
    // A constant decorated WorkgroupSize overrides the execution mode.
    let composite = module.annotations.iter().find(|i| i.operands.get(2) == Some(&Operand::BuiltIn(BuiltIn::WorkgroupSize)));
    if let Some(composite) = composite.and_then(|i| id(i, 0)) {
        let composite = tables.global(composite)?;
        for axis in 0..3 {
            let constant = id(composite, axis).context("workgroup size of unknown form")?;
            ids[axis] = tables.decoration(constant, Decoration::SpecId);
            size[axis] = literal(tables.global(constant)?, 0).context("workgroup size of unknown form")?;
        }
    }
    Ok((size, ids))
}

type Push = (Option<Layout>, Vec<(String, bool, bool)>);

fn push_constants(module: &Module, tables: &Tables) -> Result<Push> {
    let variable = module
        .types_global_values
        .iter()
        .find(|i| i.class.opcode == Op::Variable && i.operands.first() == Some(&Operand::StorageClass(StorageClass::PushConstant)));
    let Some(variable) = variable else { return Ok((None, Vec::new())) };
    let pointer = tables.global(variable.result_type.context("push constants without type")?)?;
    let block = id(pointer, 1).context("push constants without block")?;
    let layout = tables.layout(block)?.context("push constants without layout")?;
    if layout.end > 128 {
        bail!("the push-constant block {} has {} bytes; every device has 128, and no more is sure", layout.name, layout.end);
    }
    let mut accesses = Vec::new();
    for (index, operand) in (0..).zip(&tables.global(block)?.operands) {
        let mut member = operand.id_ref_any().context("push-constant member without type")?;
        if tables.global(member)?.class.opcode == Op::TypeArray {
            member = id(tables.global(member)?, 0).context("array without element type")?;
        }
        let Some(target) = tables.referenced(member)? else { continue };
        let count = tables.global(target)?.operands.len() as u32;
        let all = |wanted| (0..count).all(|m| tables.has_member_decoration(target, m, wanted));
        let name = tables.member_names.get(&(block, index)).copied().unwrap_or_default();
        accesses.push((name.to_owned(), !all(Decoration::NonReadable), !all(Decoration::NonWritable)));
    }
    Ok((Some(layout), accesses))
}

fn layouts(module: &Module, tables: &Tables) -> Result<BTreeMap<String, Layout>> {
    let mut found: BTreeMap<String, Layout> = BTreeMap::new();
    let structs = module.types_global_values.iter().filter(|i| i.class.opcode == Op::TypeStruct);
    for target in structs.filter_map(|i| i.result_id) {
        let Some(mut layout) = tables.layout(target)? else { continue };
        let arrays = module.types_global_values.iter().filter(|i| matches!(i.class.opcode, Op::TypeArray | Op::TypeRuntimeArray));
        layout.stride = arrays.filter(|i| id(i, 0) == Some(target)).find_map(|i| tables.decoration(i.result_id?, Decoration::ArrayStride));
        if layout.name.is_empty() || layout.members.is_empty() {
            continue;
        }
        merge(&mut found, layout)?;
    }
    Ok(found)
}

/// Adds a layout to those known by name. One name must mean one layout, except that a stride may be known in one place only.
pub fn merge(known: &mut BTreeMap<String, Layout>, layout: Layout) -> Result<()> {
    match known.get_mut(&layout.name) {
        None => {
            known.insert(layout.name.clone(), layout);
        }
        Some(other) => {
            let differs =
                other.members != layout.members || (other.stride.is_some() && layout.stride.is_some() && other.stride != layout.stride);
            if differs {
                bail!("two layouts have the name {}", layout.name);
            }
            other.stride = other.stride.or(layout.stride);
        }
    }
    Ok(())
}
