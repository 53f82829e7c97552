#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Makes the lists of leaf cells by counting, for a run of split cells an invocation: the pairs of each split cell lie side by side in the
// order of its leaf cells, so no sort of all pairs is needed. The ends of the lists are the counters. Where a run is too long for one
// invocation, all pairs are sorted together instead, by the steps that follow, which otherwise have no workgroups.

#include "shared/leaf_arguments.glsl"
#include "shared/overlap.glsl"
#include "shared/split.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 8) in;
layout(constant_id = 1) const uint LEAF_RUN = 6000;

layout(buffer_reference, std430, buffer_reference_align = 4) buffer ReferencesInOut { uint row[]; };

layout(push_constant, std430) uniform LeafSort {
    StateIn state; // of the second level
    SplitCellsIn split_cells;
    UintsIn offsets;
    UintsIn masks; // and, behind what the first level has there, the leaf cells of large boxes
    UintsIn boxes;
    ReferencesInOut references;
    UintsInOut cells;
    LeafArgumentsInOut arguments;
    uint pass_capacity;
};

// Turns of an invocation's loops, at most: a run has LEAF_RUN before its last split cell, and that the rest. lavapipe ends loops after 65,535 turns
// of a subgroup, whose lanes wait in each loop for the one that takes most: so one lane's references and pairs count, and another's leaf cells.
// Those are at most two thirds of the work, where lists of 1,024 triangles have 32^3 leaf cells: of a LEAF_RUN of 16,000, and 4,096 turns of the
// last split cell. With some 800 of the searches and of the records these are 47,600 in all.
const uint MOST_WORK = 32000u;

// The turns that split cells take: references are passed by twice, two pairs of one in a turn, and eight leaf cells in a turn once.
uint work_of(uint pairs, uint reference_count, uint leaf_cells) { return pairs + 2u * reference_count + leaf_cells / 8u; }

uint work_before(uint record) {
    uint reference = split_cells.cell[record].first_reference;
    return work_of(offsets.word[reference], reference, split_cells.cell[record].leaf_begin);
}

// The first of `count` split cells with so much work before it.
uint first_with(uint work, uint count) {
    uint low = 0u;
    uint high = count;
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (work_before(middle) < work) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

// The split cells with leaf cells: those for which there was no room come last.
uint fitting() {
    uint low = 0u;
    uint high = state.state.split_cells;
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (split_cells.cell[middle].level != 0u) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

// Goes through the pairs of the references up to `end`, those of split cells from `record` on: counts them, or puts them where they belong. Two
// a turn, of one triangle and so in two lists: the counter of the one need not wait for the other's.
void pass_by(uint record, uint reference, uint end, uint first_cell, uint first_pair, bool emits) {
    uint cell_end = reference;
    uint leaf_begin = 0u;
    uint to_list = 0u;
    uint row = 0u;
    // What is left of the current reference: of a small box, and of a large one.
    uint mask = 0u;
    uint large_count = 0u;
    uint large_pair = 0u;
    SmallLeafBox box = small_leaf_box(0u);
    while (reference < end || (mask | large_count) != 0u) {
        if ((mask | large_count) == 0u) {
            if (reference == cell_end) {
                leaf_begin = first_cell + split_cells.cell[record].leaf_begin;
                to_list = split_cells.cell[record].list_begin - reference;
                cell_end = reference + split_cells.cell[record].list_length;
                record += 1u;
            }
            uint box_word = boxes.word[reference];
            mask = masks.word[reference];
            if (box_word == LARGE_LEAF_BOX) {
                uint before = offsets.word[reference];
                large_count = offsets.word[reference + 1u] - before;
                large_pair = first_pair + before;
            }
            if (emits) {
                row = references.row[to_list + reference];
            }
            box = small_leaf_box(box_word);
            box.low += leaf_begin;
            reference += 1u;
        }
        if ((mask | large_count) != 0u) {
            uint rest = mask & (mask - 1u);
            bool two = rest != 0u || large_count > 1u;
            uint a = box.low + id_within(uint(findLSB(mask)), box.inverse, box.to_row, box.to_slice);
            uint b = box.low + id_within(uint(findLSB(rest)), box.inverse, box.to_row, box.to_slice);
            mask = rest & (rest - 1u);
            if (large_count != 0u) {
                a = first_cell + masks.word[large_pair];
                b = first_cell + masks.word[large_pair + uint(two)];
                large_pair += 2u;
                large_count -= min(large_count, 2u);
            }
            b = two ? b : a;
            uint a_end = cells.word[2u * a + 1u];
            uint b_end = cells.word[2u * b + 1u];
            cells.word[2u * a + 1u] = a_end + 1u;
            if (two) {
                cells.word[2u * b + 1u] = b_end + 1u;
            }
            if (emits) {
                references.row[a_end] = row;
                if (two) {
                    references.row[b_end] = row;
                }
            }
        }
    }
}

// Turns the number of pairs of a leaf cell into the beginning of its list, which is its end as long as nothing is in it.
uint begin_list(uint at, uint next) {
    uint count = cells.word[at + 1u];
    uint begin = count == 0u ? 0u : next;
    cells.word[at] = begin;
    cells.word[at + 1u] = begin;
    return next + count;
}

void main() {
    uint first_cell = state.state.first_cell;
    uint first_pair = state.state.first_pair;
    uint begin = invocation_index() * LEAF_RUN;
    uint count = fitting();
    uint first = first_with(begin, count);
    uint last = first_with(begin + LEAF_RUN, count);
    if (first >= last) {
        return;
    }
    uint reference = split_cells.cell[first].first_reference;
    uint leaf = split_cells.cell[first].leaf_begin;
    uint reference_end = split_cells.cell[last - 1u].first_reference + split_cells.cell[last - 1u].list_length;
    uint leaf_end = split_cells.cell[last - 1u].leaf_begin + leaf_count_of(split_cells.cell[last - 1u].level);
    uint pair = offsets.word[reference];
    uint pairs = offsets.word[reference_end] - pair;
    if (work_of(pairs, reference_end - reference, leaf_end - leaf) > MOST_WORK) {
        // Whoever else does so writes the same.
        write_sort(arguments, state.state.pair_count, state.state.pass_count, state.state.digit_bits, pass_capacity);
        return;
    }
    for (uint record = first; record < last; ++record) {
        uint cell = split_cells.cell[record].cell;
        cells.word[2u * cell] = first_cell + split_cells.cell[record].leaf_begin;
        cells.word[2u * cell + 1u] = CELL_SPLIT | split_cells.cell[record].level;
    }
    pass_by(first, reference, reference_end, first_cell, first_pair, false);
    uint next = first_pair + pair;
    for (; leaf < leaf_end; leaf += 8u) {
        // There are eight at least of any split cell.
        uint at = 2u * (first_cell + leaf);
        next = begin_list(at, next);
        next = begin_list(at + 2u, next);
        next = begin_list(at + 4u, next);
        next = begin_list(at + 6u, next);
        next = begin_list(at + 8u, next);
        next = begin_list(at + 10u, next);
        next = begin_list(at + 12u, next);
        next = begin_list(at + 14u, next);
    }
    pass_by(first, reference, reference_end, first_cell, first_pair, true);
}
