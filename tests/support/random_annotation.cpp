#include "tests/support/random_annotation.h"

#include <bit>
#include <functional>
#include <string_view>
#include <utility>

#include "engine/annotation/density_brush.h"
#include "engine/annotation/trace/trace_edit.h"

namespace shvr::test {

namespace {

uint64_t mixed(uint64_t hash, uint64_t value)
{
    hash = (hash ^ value) * 0x9e3779b97f4a7c15u;
    return hash ^ (hash >> 29);
}

template <class Field>
uint64_t hash_of_bricks(const Field& field, uint64_t hash)
{
    for (const int64_t index : field.painted_bricks()) {
        const auto& brick = *field.brick(index);
        const std::string_view bytes(reinterpret_cast<const char*>(brick.data()), brick.size() * sizeof brick[0]);
        hash = mixed(mixed(hash, std::hash<std::string_view>()(bytes)), uint64_t(index));
    }
    return hash;
}

constexpr const char* LOCKS = "locks";  // the setting; its text is a digit, 0 for none

}  // namespace

VolumeInfo annotated_volume()
{
    VolumeInfo volume;
    volume.name = "annotated";
    volume.size = ANNOTATED_SIZE;
    volume.type = ANNOTATED_TYPE;
    volume.spacing = {1.0, 1.0, 1.5};
    volume.unit = "um";
    return volume;
}

Document unannotated()
{
    return {.mask = Mask(ANNOTATED_SIZE), .trace = {}, .density = DensityField(ANNOTATED_SIZE, ANNOTATED_TYPE)};
}

WorkFiles files_in(const std::filesystem::path& folder)
{
    return {.journal = folder / "a.journal",
            .mask = folder / "a.mask",
            .trace = folder / "a.graphml",
            .density = folder / "a.offset",
            .volume_hash = "xxh3-128:00112233445566778899aabbccddeeff",
            .volume = annotated_volume()};
}

WorkFiles sparse_files_in(const std::filesystem::path& folder)
{
    WorkFiles files = files_in(folder);
    files.mask = folder / "a.zarr";
    files.density = folder / "a.offsets.zarr";
    return files;
}

uint64_t hash_of(const Mask& mask)
{
    return hash_of_bricks(mask, 1);
}

uint64_t hash_of(const DensityField& field)
{
    return hash_of_bricks(field, uint64_t(field.voxels()));
}

uint64_t hash_of(const TraceGraph& trace)
{
    uint64_t hash = 2;
    for (const auto& [number, node] : trace.nodes()) {
        for (int axis = 0; axis < 3; ++axis) hash = mixed(hash, std::bit_cast<uint64_t>(node.position[axis]));
        hash = mixed(mixed(mixed(hash, std::bit_cast<uint64_t>(node.radius)), node.group), number);
    }
    for (const auto& [number, internode] : trace.internodes())
        hash = mixed(mixed(mixed(mixed(hash, internode.a), internode.b), internode.group), number);
    for (const auto& [group, radius] : trace.internode_radii())
        hash = mixed(mixed(hash, group), std::bit_cast<uint64_t>(radius));
    return hash;
}

uint64_t hash_of(const Document& document)
{
    uint64_t hash = mixed(mixed(hash_of(document.mask), hash_of(document.density)), hash_of(document.trace));
    for (const auto& [name, value] : document.settings.values())
        hash = mixed(mixed(hash, std::hash<std::string>()(name)), std::hash<std::string>()(value));
    return hash;
}

GroupSet locks_of(const Document& document)
{
    GroupSet locked;
    const auto found = document.settings.values().find(LOCKS);
    if (found == document.settings.values().end() || found->second == "0") return locked;
    for (size_t group = 1; group < locked.size(); ++group) locked[group] = group % 4 == size_t(found->second[0] - '1');
    return locked;
}

std::vector<Change> all_changes_between(const Document& from, const Document& to)
{
    std::vector<Change> changes;
    for (const Part part : PARTS)
        for (Change& change : changes_between(part, from, to)) changes.push_back(std::move(change));
    SettingValues before = from.settings.values(), after = to.settings.values();
    for (const auto& [name, value] : to.settings.values()) before.try_emplace(name, "");
    for (const auto& [name, value] : before)
        if (after[name] != value) changes.emplace_back(SettingChange{name, value, after[name]});
    return changes;
}

Command random_painting(const Document& document, std::mt19937& random)
{
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    VoxelSelection selection(ANNOTATED_SIZE);
    const auto what = random() % 3;  // groups, offsets, both
    DensityStroke density(ANNOTATED_SIZE, {1, 1, 1.5}, ANNOTATED_TYPE, double(random() % 400) - 100.0,
                          random() % 2 == 0 ? Falloff::flat : Falloff::distance);
    for (auto dabs = 1 + random() % 3; dabs > 0; --dabs) {
        const auto shape = random() % 2 == 0 ? RegionShape::ball : RegionShape::box;
        const glm::dvec3 centre(uniform(-2, 47), uniform(-2, 42), uniform(-2, 37));
        const double radius = uniform(0.5, 6.0);
        const BrushRegion region = make_region(shape, centre, radius, {1, 1, 1.5}, ANNOTATED_SIZE);
        std::vector<uint32_t> words(size_t(region.words_per_row()) * region.rows.size());
        const auto share = random() % 3;
        for (uint32_t& word : words)
            word = share == 0 ? ~0u : share == 1 ? uint32_t(random()) : uint32_t(random() & random() & random());
        selection.add(region, words);
        density.add(region, words, centre, radius);
    }
    const auto group = uint8_t(random() % 3 == 0 ? 0 : random() % 256);
    Command command{"random", {}};
    const PaintRule rule{.group = group, .only_unpainted = random() % 4 == 0, .locked = locks_of(document)};
    if (what != 1) command.changes = as_changes(paint_changes(document.mask, selection, rule));
    if (what != 0)
        for (DensityBrickChange& change : density.changes(document.density))
            command.changes.emplace_back(std::move(change));
    return command;
}

Command random_tracing(const Document& document, std::mt19937& random)
{
    const TraceGraph& trace = document.trace;
    const auto place = [&] {
        const auto along = [&](int64_t side) {
            return std::uniform_real_distribution<double>(0.0, double(side))(random);
        };
        return glm::dvec3(along(ANNOTATED_SIZE.x), along(ANNOTATED_SIZE.y), along(ANNOTATED_SIZE.z));
    };
    const auto group = uint8_t(random() % 5);
    const double radius = double(random() % 64) / 16.0;
    // The command includes the change of selection, like the commands of the tools.
    TraceGraph selected = trace;
    if (!trace.nodes().empty() && random() % 2 == 0) selected.select(nearest_node_selection(trace, place()));
    const auto has_node = selected.selection().node().has_value();
    std::vector<TraceChange> changes{TraceSelectionChange{trace.selection(), {}},
                                     TraceSelectionChange{{}, selected.selection()}};
    std::vector<TraceChange> more;
    const auto what = random() % 8;
    if (what < 3 || !has_node)
        more = add_node(selected, {place(), radius, group});
    else if (what == 3) {
        const std::optional<uint32_t> to = trace.nearest_node(place(), selected.selection().node());
        if (to && !trace.internode_between(*selected.selection().node(), *to)) more = link_selected(selected, *to);
    } else if (what == 4)
        more = move_selected(selected, place());
    else if (what == 5)
        more = delete_selected(selected);
    else if (what == 6)
        more = set_group_of_selected(selected, group);
    else if (random() % 2 == 0)
        more = set_internode_radius(trace, group, random() % 2 == 0 ? std::optional(radius) : std::nullopt);
    else
        more = set_node_radii(trace, group, radius);
    if (more.empty()) return {"nothing", {}};
    Command command{"trace", {}};
    for (TraceChange& change : changes) command.changes.emplace_back(std::move(change));
    for (TraceChange& change : more) command.changes.emplace_back(std::move(change));
    return command;
}

Command random_setting(const Document& document, std::mt19937& random)
{
    const SettingValues& values = document.settings.values();
    const auto section = random() % 4;
    const std::string name = section == 3 ? LOCKS : sentence("section ", section);
    const auto found = values.find(name);
    const std::string before = found == values.end() ? std::string() : found->second;
    const auto value = random() % 5;
    const std::string after = section == 3 ? sentence(value) : sentence("{\"value\":", value % 4, "}");
    if (before == after) return {"nothing", {}};
    return {"setting", {SettingChange{name, before, after}}};
}

SettingValues random_kept(std::mt19937& random)
{
    const std::string name = sentence("view ", random() % 3);
    return {{name, sentence("{\"value\":", random() % 4, "}")}};
}

Command random_command(const Document& document, std::mt19937& random)
{
    if (random() % 8 == 0) return random_setting(document, random);
    return random() % 3 == 0 ? random_tracing(document, random) : random_painting(document, random);
}

}  // namespace shvr::test
