#include "engine/workbench/lists/history_list.h"

#include <limits>

namespace shvr::ui {

namespace {

class Places {
public:
    explicit Places(const VolumeInfo& volume) : volume_(volume) {}

    void add(const TraceNode& node) { add(node.position / volume_.spacing, node.position / volume_.spacing); }
    /// A run covers consecutive voxels of a brick, x fastest, so its first and last voxel determine its bounding box.
    template <class Value>
    void add(const BrickChange<Value>& change)
    {
        const glm::dvec3 corner = glm::dvec3(position_of(change.brick, brick_grid(volume_.size))) * double(BRICK_SIDE);
        for (const BrickRun<Value>& run : change.runs) {
            const glm::dvec3 first = voxel_in_brick(run.first), last = voxel_in_brick(run.last);
            const bool is_one_row = first.y == last.y && first.z == last.z, is_one_slice = first.z == last.z;
            const double low_x = is_one_row ? first.x : 0.0, high_x = is_one_row ? last.x : BRICK_SIDE - 1;
            const double low_y = is_one_slice ? first.y : 0.0, high_y = is_one_slice ? last.y : BRICK_SIDE - 1;
            add(corner + glm::dvec3(low_x, low_y, first.z), corner + glm::dvec3(high_x, high_y, last.z) + 1.0);
        }
    }
    std::optional<PlaceBox> box() const
    {
        return box_.lower.x > box_.upper.x
                   ? std::nullopt
                   : std::optional<PlaceBox>({box_.lower, glm::min(box_.upper, glm::dvec3(volume_.size))});
    }

private:
    static glm::dvec3 voxel_in_brick(int index)
    {
        return {index % BRICK_SIDE, index / BRICK_SIDE % BRICK_SIDE, index / (BRICK_SIDE * BRICK_SIDE)};
    }
    void add(const glm::dvec3& lower, const glm::dvec3& upper)
    {
        box_ = {glm::min(box_.lower, lower), glm::max(box_.upper, upper)};
    }

    const VolumeInfo& volume_;
    PlaceBox box_{glm::dvec3(std::numeric_limits<double>::infinity()),
                  glm::dvec3(-std::numeric_limits<double>::infinity())};
};

void add(Places& places, const TraceChange& change, const TraceGraph& trace)
{
    const auto add_ends = [&](const std::optional<TraceInternode>& internode) {
        if (!internode) return;
        for (const uint32_t number : {internode->a, internode->b})
            if (const auto node = trace.nodes().find(number); node != trace.nodes().end()) places.add(node->second);
    };
    std::visit(ByKind{[&](const TraceNodeChange& node) {
                          if (node.before) places.add(*node.before);
                          if (node.after) places.add(*node.after);
                      },
                      [&](const TraceInternodeChange& internode) {
                          add_ends(internode.before);
                          add_ends(internode.after);
                      },
                      [](const TraceSizeChange&) {}, [](const TraceSelectionChange&) {}},
               change);
}

}  // namespace

size_t HistoryList::rows() const
{
    const size_t steps = history ? history->undoable() + history->redoable() : 0;
    return 1 + (is_ahead ? done + 1 : steps);
}

std::string HistoryList::label_of(size_t row) const
{
    if (row == 0) return "as it was opened first";
    return is_ahead && row == present() ? "settings" : history->label_of(row - 1);
}

HistoryList history_list(const Model& model)
{
    if (!model.history) return {};
    return {model.history, model.history->undoable(), model.undoable > model.history->undoable()};
}

std::optional<Action> go_to_row(const HistoryList& list, size_t row)
{
    const size_t present = list.present();
    if (row == present || row >= list.rows()) return std::nullopt;
    if (row < present) return UndoOp{int(present - row)};
    return RedoOp{int(row - present)};
}

std::optional<PlaceBox> place_of_row(const HistoryList& list, const Model& model, size_t row)
{
    if (row == 0 || row >= list.rows() || (list.is_ahead && row == list.present())) return std::nullopt;
    Places places(model.volume);
    list.history->look_at(row - 1, [&](std::span<const Change> changes) {
        for (const Change& change : changes)
            std::visit(
                ByKind{[&](const MaskBrickChange& mask) { places.add(mask); },
                       [&](const DensityBrickChange& density) { places.add(density); },
                       [&](const TraceChange& trace) { add(places, trace, model.trace); }, [](const SettingChange&) {}},
                change);
    });
    return places.box();
}

}  // namespace shvr::ui
