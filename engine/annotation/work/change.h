#pragma once
// Everything that is annotated, and the records through which it changes: exact before and after, so that undo is the
// same record backwards. A new kind of annotation is one more alternative of `Change`; the compiler then names every
// place that does not handle it yet.
//
// Not thread safe: the main thread owns a document.

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

/// A visitor of changes, made of one function for each kind: std::visit(ByKind{...}, change). It does not compile where
/// a kind is left out.
template <class... Cases>
struct ByKind : Cases... {
    using Cases::operator()...;
};
template <class... Cases>
ByKind(Cases...) -> ByKind<Cases...>;  // clang 16 does not deduce aggregates by itself

/// Records of one kind, as a command takes them.
template <class Record>
std::vector<Change> as_changes(std::vector<Record> records)
{
    return {std::make_move_iterator(records.begin()), std::make_move_iterator(records.end())};
}

struct Command {
    std::string label;  ///< text for the status bar: "flood fill, group 3"
    std::vector<Change> changes;
};

/// A record that does not fit is our mistake (SHVR_CHECK).
void apply(Document& document, const Change& change, Direction direction);
/// All of them in order, or in reverse order backwards. For records from files: fails with the reason if one does
/// not fit, and then the document is as it was.
void apply_if_it_fits(Document& document, std::span<const Change> changes, Direction direction);
/// About how much memory they take.
uint64_t memory_of(std::span<const Change> changes);

/// Which parts of a document some changes are about.
struct Touched {
    int64_t voxels = 0;                  ///< that change their group, plus those that change their offset
    std::vector<int64_t> mask_bricks{};  ///< with voxels that change their group
    std::vector<VoxelBox> raised{};      ///< around voxels that change their offset
    bool trace = false;
    bool settings = false;
};
Touched touched_by(const Document& document, std::span<const Change> changes);

}  // namespace shvr
