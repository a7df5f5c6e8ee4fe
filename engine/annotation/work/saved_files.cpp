#include "engine/annotation/work/saved_files.h"

#include <sys/stat.h>

#include <map>
#include <set>

#include "engine/annotation/files/mask_image.h"
#include "engine/annotation/files/mask_import.h"
#include "engine/annotation/files/offset_import.h"
#include "engine/annotation/work/journal_file.h"
#include "engine/annotation/writers/no_replace.h"
#include "engine/base/atomic_writer.h"
#include "engine/projects/atomic_folder.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

template <class Value>
std::vector<Change> bricks_between(const SparseBricks<Value>& from, const SparseBricks<Value>& to)
{
    const std::vector<int64_t> before = from.painted_bricks(), after = to.painted_bricks();
    std::set<int64_t> indices(before.begin(), before.end());
    indices.insert(after.begin(), after.end());
    std::vector<Change> changes;
    for (const int64_t index : indices) {
        const auto &old = from.brick(index), &now = to.brick(index);
        if (old == now) continue;  // shared
        BrickChange<Value> change{index, {}};
        for (size_t i = 0; i < VOXELS_PER_BRICK; ++i)
            append_run(change.runs, i, i, old ? (*old)[i] : Value{0}, now ? (*now)[i] : Value{0});
        if (!change.runs.empty()) changes.emplace_back(std::move(change));
    }
    return changes;
}

/// `gone`: removes the objects that `to` lacks. `made`: adds or changes the objects of `to` that are new or different.
template <class Record, class Map>
void differences(const Map& from, const Map& to, std::vector<Record>& gone, std::vector<Record>& made)
{
    for (const auto& [number, value] : from)
        if (const auto found = to.find(number); found == to.end()) gone.push_back({number, value, {}});
    for (const auto& [number, value] : to) {
        const auto found = from.find(number);
        if (found == from.end())
            made.push_back({number, {}, value});
        else if (!(found->second == value))
            made.push_back({number, found->second, value});
    }
}

std::vector<Change> traces_between(const TraceGraph& from, const TraceGraph& to)
{
    std::vector<TraceNodeChange> lost_nodes, nodes;
    std::vector<TraceInternodeChange> lost_links, links;
    std::vector<TraceSizeChange> lost_sizes, sizes;
    differences(from.nodes(), to.nodes(), lost_nodes, nodes);
    differences(from.internodes(), to.internodes(), lost_links, links);
    differences(from.internode_radii(), to.internode_radii(), lost_sizes, sizes);
    // An internode that is to join other nodes is removed, then added again. All removals precede all additions,
    // because two nodes can be joined only once.
    std::vector<TraceInternodeChange> joins;
    for (TraceInternodeChange& link : links) {
        if (link.before && (link.before->a != link.after->a || link.before->b != link.after->b)) {
            lost_links.push_back({link.internode, link.before, {}});
            link.before.reset();
        }
        joins.push_back(link);
    }
    std::vector<Change> changes;
    const auto add = [&](const auto& records) {
        for (const auto& record : records) changes.emplace_back(TraceChange(record));
    };
    add(lost_links);
    add(lost_nodes);
    add(nodes);
    add(joins);
    add(lost_sizes);
    add(sizes);
    if (changes.empty()) return changes;
    // Deselects first, so that the selection never refers to a missing object, neither on redo nor on undo.
    changes.insert(changes.begin(), TraceChange(TraceSelectionChange{from.selection(), {}}));
    return changes;
}

}  // namespace

const char* name_of(Part part)
{
    switch (part) {
        case Part::mask: return "mask";
        case Part::trace: return "trace";
        case Part::offsets: return "density offsets";
    }
    return "";
}

const fs::path& file_of(const WorkFiles& files, Part part)
{
    return part == Part::mask ? files.mask : part == Part::trace ? files.trace : files.density;
}

std::optional<uint64_t>& digest_of(SavedFiles& digests, Part part)
{
    return part == Part::mask ? digests.mask : part == Part::trace ? digests.trace : digests.density;
}

bool holds_any(const Document& document, Part part)
{
    switch (part) {
        case Part::mask: return !document.mask.painted_bricks().empty();
        case Part::trace: return !document.trace.nodes().empty();
        case Part::offsets: return document.density.voxels() > 0;
    }
    return false;
}

bool is_there(const fs::path& path)
{
    std::error_code ignored;
    return !path.empty() && fs::exists(path, ignored);
}

const fs::path& file_to_read(const WorkFiles& files, Part part)
{
    const bool is_saved = part != Part::mask || files.mask_to_read.empty() || is_there(files.mask);
    return is_saved ? file_of(files, part) : files.mask_to_read;
}

const fs::path& mask_of_header(const WorkFiles& files)
{
    return files.mask_before.empty() ? file_to_read(files, Part::mask) : files.mask_before;
}

LoadNotes load(Part part, const WorkFiles& files, Document& into)
{
    const TraceSpace space = space_of(files.volume);
    switch (part) {
        case Part::mask: {
            // Checks the size (in import_mask) before the image: if both differ, the size is the better explanation.
            const fs::path& file = file_to_read(files, part);
            ImportedMask mask = import_mask(file, space);
            check_mask_image(file, files.volume_hash, files.is_other_name);
            for (const MaskBrickChange& change : mask.changes) into.mask.apply(change, Direction::forwards);
            return {std::move(mask.losses), std::move(mask.remarks)};
        }
        case Part::trace: {
            TraceFile file = load_trace(files.trace, space);
            into.trace = std::move(file.trace);
            return {.losses = std::move(file.warnings)};
        }
        case Part::offsets: into.density = import_offsets(files.density, space, into.density.type()); return {};
    }
    return {};
}

std::vector<Change> changes_between(Part part, const Document& from, const Document& to)
{
    switch (part) {
        case Part::mask: return bricks_between(from.mask, to.mask);
        case Part::trace: return traces_between(from.trace, to.trace);
        case Part::offsets: return bricks_between(from.density, to.density);
    }
    return {};
}

std::optional<uint64_t> trace_digest(const WorkFiles& files, const TraceGraph& trace)
{
    try {
        const std::string text = trace_text(files.trace, trace, space_of(files.volume));
        return digest_of(std::as_bytes(std::span(text)));
    } catch (const Error&) {
        return std::nullopt;
    }
}

std::optional<FileStamp> stamp_of(const fs::path& path)
{
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
    const auto in_ns = [](const timespec& time) { return int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec; };
    return FileStamp{in_ns(status.st_mtim), in_ns(status.st_ctim), uint64_t(status.st_size), status.st_ino};
}

fs::path old_of(const fs::path& path)
{
    return free_old_name(path);
}

std::optional<fs::path> set_aside(const fs::path& path)
{
    return rename_to_old(path, path);
}

std::optional<fs::path> rename_to_old(const fs::path& file, const fs::path& path)
{
    for (;;) {
        const fs::path old = old_of(path);
        switch (move_to_free(file, old)) {
            case Renaming::done: sync_folder(old); return old;
            case Renaming::name_taken: break;  // by another process, just now
            case Renaming::gone: return std::nullopt;
        }
    }
}

}  // namespace shvr
