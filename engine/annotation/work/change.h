#pragma once
// The annotated document, and the records through which it changes. A
// record holds the exact states before and after a change, so undo applies
// the same record backwards. To add a kind of annotation, add an
// alternative to `Change`; the compiler then reports all code that does not
// handle it yet.

#include <cstdint>
#include <iterator>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "engine/annotation/density.h"
#include "engine/annotation/mask.h"
#include "engine/annotation/settings.h"
#include "engine/annotation/trace/tracing.h"

namespace shvr {

/// Only `apply` changes the annotation.
struct Document {
    Mask mask;
    TraceGraph trace;
    DensityField density{};
    Settings settings{};
};

using Change = std::variant<MaskBrickChange, TraceChange, DensityBrickChange, SettingChange>;

/// A visitor of changes with one function for each kind: std::visit(ByKind{...}, change). Does not compile if the
/// function for a kind is missing.
template <class... Cases>
struct ByKind : Cases... {
    using Cases::operator()...;
};
template <class... Cases>
ByKind(Cases...) -> ByKind<Cases...>;  // clang 16 needs this guide to deduce an aggregate's arguments

/// Converts records of one kind to changes, for a command.
template <class Record>
std::vector<Change> as_changes(std::vector<Record> records)
{
    return {std::make_move_iterator(records.begin()), std::make_move_iterator(records.end())};
}

struct Command {
    std::string label;  ///< what was done, for the history: "painted group 3 with flood fill"
    std::vector<Change> changes;
};

/// Applies a change. A change that does not fit is a bug (SHVR_CHECK).
void apply(Document& document, const Change& change, Direction direction);
/// Applies all changes in order or, if backwards, in reverse order. For records from files: if one of the records does
/// not fit, fails with the reason and leaves the document unchanged.
void apply_if_it_fits(Document& document, std::span<const Change> changes, Direction direction);
/// Their approximate memory use.
uint64_t memory_of(std::span<const Change> changes);

/// The parts of a document that some changes affect.
struct Touched {
    int64_t voxels = 0;                  ///< voxels that change their group, plus voxels that change their offset
    std::vector<int64_t> mask_bricks{};  ///< bricks with voxels that change their group
    std::vector<VoxelBox> raised{};      ///< boxes around voxels that change their offset
    bool trace = false;
    bool settings = false;
};
Touched touched_by(const Document& document, std::span<const Change> changes);

}  // namespace shvr
