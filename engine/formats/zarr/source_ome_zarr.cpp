#include "engine/formats/zarr/source_ome_zarr.h"

// Opens OME-Zarr images, versions 0.1 to 0.4 (Zarr version 2) and 0.5 (Zarr version 3), and bare Zarr arrays, in a
// local folder, an archive or below an address (zarr_store.h). A project is such an image with an additional folder
// shvr/ (project.h) that holds ranges and statistics.
//
// Levels are the datasets that are aligned with level 0 as source.h requires: each level is twice as coarse as the one
// before, along every axis. Other datasets are left out, with a warning.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/choice.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/readers.h"
#include "engine/formats/zarr/ome_place.h"
#include "engine/formats/zarr/ome_zarr.h"
#include "engine/formats/zarr/project_knowledge.h"
#include "engine/formats/zarr/store/remote_store.h"
#include "engine/formats/zarr/store/zarr_json.h"
#include "engine/formats/zarr/zarr_gaps.h"
#include "engine/formats/zarr/zarr_volume.h"
#include "engine/remote/address.h"
#include "engine/volume/grid.h"
#include "shaders/bricks.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

constexpr int64_t CACHE_BYTES = int64_t{64} << 20;
constexpr int MAX_LEVELS = 24;
/// Limits of one parallel request for remote chunks: their decoded bytes, and their number.
constexpr int64_t PREPARED_BYTES = int64_t{64} << 20, MAX_PREPARED = 64;

class OmeZarrSource : public VolumeSource {
public:
    OmeZarrSource(VolumeInfo info, std::vector<ZarrVolume> volumes, ProjectKnowledge knowledge)
        : VolumeSource(std::move(info)),
          volumes_(std::move(volumes)),
          knowledge_(std::move(knowledge)),
          gaps_(volumes_),
          cache_(CACHE_BYTES)
    {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }

    int levels() const override { return int(volumes_.size()); }

    Size3 block() const override { return volumes_[0].chunk(); }

    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        SHVR_CHECK(level >= 0 && level < levels(), level);
        const ZarrVolume& volume = volumes_[size_t(level)];
        if (glm::all(glm::lessThanEqual(box.upper, volume.size()))) return read_stored(level, box, voxels);
        read_beyond(level, box, voxels);
    }

    std::optional<ValueRange> brick_range(int level, const Size3& brick) const override
    {
        if (level < 0 || level >= levels()) return std::nullopt;
        const Size3 size = size_of_level(info().size, level);
        const Size3 counts = size_of_level(size, 5);
        static_assert(BRICK_SIDE == 32);
        const bool is_inside =
            glm::all(glm::greaterThanEqual(brick, Size3(0))) && glm::all(glm::lessThan(brick, counts));
        if (!is_inside) return std::nullopt;
        if (const std::optional<ValueRange> known = range_of(knowledge_, info(), level, brick)) return known;
        return gaps_.range(level, {glm::max(brick * BRICK_SIDE - int64_t{1}, Size3(0)),
                                   glm::min((brick + int64_t{1}) * BRICK_SIDE + int64_t{1}, size)});
    }

    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override
    {
        SHVR_CHECK(level >= 0 && level < levels(), level);
        const ZarrVolume& volume = volumes_[size_t(level)];
        std::optional<std::vector<glm::ivec3>> chunks = gaps_.stored(level, most);
        if (!chunks || !volume.is_there()) return std::nullopt;
        add_beyond(level, *chunks);
        return StoredBlocks{.block = volume.chunk(), .fill = volume.fill(), .blocks = *std::move(chunks)};
    }

    std::optional<VolumeStatistics> statistics() const override
    {
        if (!knowledge_.record) return std::nullopt;
        return knowledge_.record->statistics;
    }

private:
    void read_stored(int level, const VoxelBox& box, std::span<std::byte> voxels) const
    {
        const ZarrVolume& volume = volumes_[size_t(level)];
        std::span<const Size3> wanted;
        const std::vector<Size3> uncached = volume.is_remote() ? uncached_chunks(level, box) : std::vector<Size3>();
        wanted = uncached;
        const int64_t chunk_bytes = int64_t(volume.metadata().chunk_bytes());
        const size_t most = size_t(std::clamp<int64_t>(PREPARED_BYTES / chunk_bytes, 1, MAX_PREPARED));
        volume.read(box, voxels, [&](const Size3& chunk) {
            if (!wanted.empty() && wanted.front() == chunk) {
                const size_t count = std::min(most, wanted.size());
                volume.prepare(wanted.first(count));
                wanted = wanted.subspan(count);
            }
            return cache_.get({level, volume.index_of(chunk)}, [&] { return volume.load(chunk); });
        });
    }

    /// Returns those chunks of a box that are not cached, in the order in which ZarrVolume::read requests them.
    std::vector<Size3> uncached_chunks(int level, const VoxelBox& box) const
    {
        const ZarrVolume& volume = volumes_[size_t(level)];
        const Size3 end = (box.upper - int64_t{1}) / volume.chunk() + int64_t{1};
        std::vector<Size3> chunks;
        Size3 at, first = box.lower / volume.chunk();
        for (at.z = first.z; at.z < end.z; ++at.z)
            for (at.y = first.y; at.y < end.y; ++at.y)
                for (at.x = first.x; at.x < end.x; ++at.x)
                    if (!cache_.has({level, volume.index_of(at)})) chunks.push_back(at);
        return chunks;
    }

    /// Adds the chunks beyond the stored array that consist only of repeated voxels: a level whose size was rounded
    /// down lacks its last voxels along an axis, and read_beyond() repeats the voxels before them.
    void add_beyond(int level, std::vector<glm::ivec3>& chunks) const
    {
        const ZarrVolume& volume = volumes_[size_t(level)];
        const Size3 lacking = size_of_level(info().size, level) - volume.size();
        for (int axis = 0; axis < 3; ++axis) {
            if (lacking[axis] == 0 || volume.size()[axis] % volume.chunk()[axis] != 0) continue;
            for (size_t i = 0, count = chunks.size(); i < count; ++i) {
                if (int64_t{chunks[i][axis]} + 1 != volume.counts()[axis]) continue;
                chunks.push_back(chunks[i]);
                ++chunks.back()[axis];
            }
        }
        std::ranges::sort(chunks, [](const glm::ivec3& a, const glm::ivec3& b) {
            return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
        });
    }

    /// Reads a box. If rounding down cut off the last voxels along an axis, repeats the voxels before them.
    void read_beyond(int level, const VoxelBox& box, std::span<std::byte> voxels) const
    {
        const Size3 size = volumes_[size_t(level)].size();
        const VoxelBox stored{glm::min(box.lower, size - int64_t{1}), glm::min(box.upper, size)};
        const Size3 from = stored.size();
        const Size3 to = box.size();
        const size_t bytes = bytes_of(info().type);
        std::vector<std::byte> inside(size_t(from.x * from.y * from.z) * bytes);
        read_stored(level, stored, inside);
        std::byte* voxel = voxels.data();
        for (int64_t z = 0; z < to.z; ++z) {
            for (int64_t y = 0; y < to.y; ++y) {
                for (int64_t x = 0; x < to.x; ++x, voxel += bytes) {
                    const Size3 at = glm::min(Size3(x, y, z), from - int64_t{1});
                    const auto index = size_t(index_of(at, from));
                    std::memcpy(voxel, inside.data() + index * bytes, bytes);
                }
            }
        }
    }

    std::vector<ZarrVolume> volumes_;
    ProjectKnowledge knowledge_;
    ZarrGaps gaps_;  ///< of volumes_
    mutable ChunkCache cache_;
};

std::string name_of_folder(const fs::path& path)
{
    const fs::path whole = whole_path(path);
    return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

// ---- Choosing if there is more than one -----------------------------------------------------------------------------

/// `what`: "channel" or "frame".
int64_t chosen(const fs::path& path, const char* what, const std::string& wanted, int64_t count,
               const std::vector<std::string>& names)
{
    for (size_t i = 0; i < names.size() && int64_t(i) < count; ++i) {
        if (!names[i].empty() && lower_case(names[i]) == lower_case(wanted)) return int64_t(i);
    }
    const std::optional<int64_t> number = whole_of(wanted);
    if (number && *number >= 1 && *number <= count) return *number - 1;
    if (wanted.empty() && count == 1) return 0;
    std::string choices = sentence("1 to ", count);
    constexpr size_t MAX_NAMES = 16;
    for (size_t i = 0; i < std::min(names.size(), MAX_NAMES); ++i) {
        if (!names[i].empty()) choices += sentence(i == 0 ? "; " : ", ", i + 1, " is ", in_quotes(names[i]));
    }
    if (wanted.empty()) {
        throw ChoiceNeeded(sentence(path.string(), ": holds ", count, " ", what, "s; expected a ", what,
                                    " to be chosen (", choices, ")"),
                           {Choice::numbered(what, count, names)});
    }
    fail(path.string(), ": has no ", what, " ", in_quotes(wanted), "; expected one of ", count, " (", choices, ")");
}

ZarrView view_of(const fs::path& path, const OmeImage& image, const ZarrMetadata& metadata, const OpenOptions& options)
{
    ZarrView view{.xyz = image.xyz, .at = std::vector<int64_t>(image.axes)};
    const auto choose = [&](const std::optional<size_t>& axis, const char* what, const std::string& wanted,
                            const std::vector<std::string>& names) {
        const int64_t index = chosen(path, what, wanted, axis ? metadata.shape[*axis] : 1, names);
        if (axis) view.at[*axis] = index;
    };
    choose(image.channel, "channel", options.channel, image.channels);
    choose(image.time, "frame", options.frame, {});
    return view;
}

// ---- Levels ---------------------------------------------------------------------------------------------------------

Size3 size_along(const ZarrMetadata& metadata, const std::array<size_t, 3>& xyz)
{
    return {metadata.shape[xyz[0]], metadata.shape[xyz[1]], metadata.shape[xyz[2]]};
}

/// Returns why a dataset cannot be level `level`, as a text for messages; empty if it can.
std::string objection(const OmeImage& image, const ZarrMetadata& first, size_t dataset, const ZarrMetadata& metadata,
                      int level)
{
    if (metadata.shape.size() != image.axes) return "has another number of axes";
    if (metadata.type != first.type)
        return sentence("holds ", name_of(metadata.type), ", level 0 ", name_of(first.type));
    if (metadata.stored != first.stored)
        return sentence("holds ", name_of(metadata.stored), " numbers, level 0 ", name_of(first.stored));
    for (const auto& axis : {image.channel, image.time}) {
        if (axis && metadata.shape[*axis] != first.shape[*axis]) return "has other channels or time points";
    }
    const Size3 size = size_along(first, image.xyz);
    const Size3 coarse = size_along(metadata, image.xyz);
    const auto factor = double(int64_t{1} << level);
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t floor = std::max<int64_t>(1, size[axis] >> level);
        const int64_t ceiling = size_of_level(size, level)[axis];
        if (coarse[axis] < floor || coarse[axis] > ceiling) {
            return sentence("has ", coarse[axis], " voxels along ", "xyz"[axis], ", not ", ceiling);
        }
    }
    const OmeImage::Level& fine = image.levels[0];
    const OmeImage::Level& stated = image.levels[dataset];
    for (int axis = 0; axis < 3; ++axis) {
        if (!fine.scale || !stated.scale) break;
        const double ratio = (*stated.scale)[axis] / (*fine.scale)[axis];
        if (!(std::abs(ratio / factor - 1.0) < 1e-3)) {
            return sentence("is ", ratio, " times as coarse along ", "xyz"[axis], ", not ", factor, " times");
        }
        // A coarse voxel must be centred on the fine voxels that it covers. If it is centred on the first of these
        // instead, the translation is assumed to be missing, since older programs do not write it.
        const double offset = (stated.translation ? (*stated.translation)[axis] : 0.0) -
                              (fine.translation ? (*fine.translation)[axis] : 0.0);
        const double voxels = offset / (*fine.scale)[axis];
        const double tolerance = 0.05 * factor;
        if (std::abs(voxels) > 1e-3 && !(std::abs(voxels - 0.5 * (factor - 1.0)) <= tolerance)) {
            return sentence("lies ", voxels, " voxels off along ", "xyz"[axis], ", not ", 0.5 * (factor - 1.0));
        }
    }
    return {};
}

/// Warns if the image and its first level name the axes differently; since version 0.5, the names must agree.
void compare_names(const ZarrPlace& array, const OmeImage& image, const ZarrMetadata& metadata,
                   std::vector<std::string>& warnings)
{
    for (size_t axis = 0; axis < metadata.axes.size(); ++axis) {
        const std::string& name = metadata.axes[axis];
        if (name.empty() || lower_case(name) == image.names[axis]) continue;
        warnings.push_back(sentence(array.path_of(metadata.key()).string(), ": calls axis ", axis, " ", in_quotes(name),
                                    ", the image ", in_quotes(image.names[axis]), ", which is used"));
        return;
    }
}

std::vector<ZarrVolume> open_levels(const ZarrPlace& folder, int version, const OmeImage& image,
                                    const OpenOptions& options, std::vector<std::string>& warnings)
{
    std::vector<ZarrWant> wants;
    for (const OmeImage::Level& level : image.levels)
        wants.push_back({.key = (folder / level.path).key(version == 2 ? ".zarray" : "zarr.json"),
                         .bytes = MAX_ZARR_METADATA_BYTES});
    folder.store->prepare(wants);
    const ZarrPlace array = folder / image.levels[0].path;
    const ZarrMetadata first = read_zarr_metadata(array, version);
    if (first.shape.size() != image.axes) {
        fail(array.path_of(first.key()).string(), ": shape has ", first.shape.size(), " axes; expected ", image.axes,
             ", as the image says");
    }
    const ZarrView view = view_of(folder.path_of(""), image, first, options);
    compare_names(array, image, first, warnings);
    std::vector<ZarrVolume> volumes;
    volumes.emplace_back(array, first, view);
    std::vector<std::string> left_out;
    std::string reason;
    for (size_t dataset = 1; dataset < image.levels.size() && volumes.size() < MAX_LEVELS; ++dataset) {
        const std::string& path = image.levels[dataset].path;
        std::string why;
        try {
            ZarrMetadata metadata = read_zarr_metadata(folder / path, version);
            why = objection(image, first, dataset, metadata, int(volumes.size()));
            if (why.empty()) volumes.emplace_back(folder / path, std::move(metadata), view);
        } catch (const Error& error) {
            why = sentence("cannot be read (", error.what(), ")");
        }
        if (why.empty()) continue;
        if (left_out.empty()) reason = sentence("level ", in_quotes(path), " ", why);
        left_out.push_back(path);
    }
    for (const ZarrVolume& volume : volumes)
        if (const std::string stray = volume.stray_chunk(); !stray.empty())
            warnings.push_back(
                sentence(stray, " is named like a chunk, but lies outside the array, whose last chunk is ",
                         volume.path_of(volume.counts() - int64_t{1}).lexically_relative(folder.path_of("")).string(),
                         "; its ", volume.metadata().key(), " does not match it"));
    if (!left_out.empty()) {
        std::string names;
        for (const std::string& path : left_out) names += (names.empty() ? "" : ", ") + in_quotes(path);
        warnings.push_back(sentence(left_out.size() == 1 ? "level " : "levels ", names, " of the image ",
                                    left_out.size() == 1 ? "is" : "are", " left out: ", reason));
    }
    return volumes;
}

// ---- What kind of folder it is --------------------------------------------------------------------------------------

std::unique_ptr<VolumeSource> open_image(const ZarrPlace& place, const ZarrNode& node, const OpenOptions& options)
{
    const fs::path folder = place.path_of("");
    const OmeImage image = read_ome_image(node);
    std::vector<std::string> left_out;
    std::vector<ZarrVolume> volumes = open_levels(place, node.version, image, options, left_out);
    VolumeInfo info{.name = name_of_folder(folder), .format = "ome-zarr", .size = volumes[0].size()};
    info.type = volumes[0].metadata().type;
    static_cast<void>(voxel_count(info));
    info.warnings = image.warnings;
    apply_spacing(info, image.levels[0].scale, image.unit, "um");
    read_ome_place(node.attributes(), image.levels[0].translation, info);
    ProjectKnowledge knowledge = place.store->is_remote() ? read_remote_knowledge(place, info, volumes)
                                                          : read_project_knowledge(folder, info, volumes);
    info.warnings.insert(info.warnings.end(), left_out.begin(), left_out.end());
    if (std::string offline = offline_warning(*place.store); !offline.empty())
        info.warnings.push_back(std::move(offline));
    if (node.ome()["image-label"].exists()) warn_of_labels(info.warnings, "the image holds labels");
    const StoredNumber number = volumes[0].metadata().stored;
    return widened(std::make_unique<OmeZarrSource>(std::move(info), std::move(volumes), std::move(knowledge)), number,
                   folder.string());
}

/// Returns the indices of the axes named x, y and z; null unless each of the names occurs exactly once.
std::optional<std::array<size_t, 3>> named_axes(const ZarrMetadata& metadata)
{
    std::array<size_t, 3> xyz{};
    for (size_t along = 0; along < 3; ++along) {
        const auto is_meant = [&](const std::string& name) { return lower_case(name) == std::string(1, "xyz"[along]); };
        if (std::ranges::count_if(metadata.axes, is_meant) != 1) return std::nullopt;
        xyz[along] = size_t(std::ranges::find_if(metadata.axes, is_meant) - metadata.axes.begin());
    }
    return xyz;
}

/// Opens a bare array. It states no spacing, and a version 2 array does not even name its axes.
std::unique_ptr<VolumeSource> open_array(const ZarrPlace& place, int version, const OpenOptions& options)
{
    const fs::path folder = place.path_of("");
    ZarrMetadata metadata = read_zarr_metadata(place, version);
    const size_t axes = metadata.shape.size();
    OmeImage image{.axes = axes};
    const std::optional<std::array<size_t, 3>> named = named_axes(metadata);
    image.xyz = named.value_or(std::array<size_t, 3>{axes - 1, axes - 2, axes - 3});
    bool is_volume = axes >= 3;
    for (size_t axis = 0; axis < axes; ++axis)
        is_volume = is_volume && (metadata.shape[axis] == 1 || std::ranges::find(image.xyz, axis) != image.xyz.end());
    if (!is_volume) {
        std::string shape;
        for (const int64_t side : metadata.shape) shape += sentence(shape.empty() ? "" : ",", side);
        fail(place.path_of(metadata.key()).string(), ": key shape is [", shape,
             "]; expected three axes z, y, x, all others 1 voxel long");
    }
    VolumeInfo info{.name = name_of_folder(folder), .format = "ome-zarr", .size = size_along(metadata, image.xyz)};
    info.type = metadata.type;
    static_cast<void>(voxel_count(info));
    if (!named) info.warnings.emplace_back("a Zarr array alone does not name its axes; z, y, x assumed");
    apply_spacing(info, std::nullopt, std::nullopt, "um");
    std::vector<ZarrVolume> volumes;
    const ZarrView view = view_of(folder, image, metadata, options);
    const StoredNumber number = metadata.stored;
    volumes.emplace_back(place, std::move(metadata), view);
    return widened(std::make_unique<OmeZarrSource>(std::move(info), std::move(volumes), ProjectKnowledge{}), number,
                   folder.string());
}

/// Returns the images in a group that is no image itself. bioformats2raw numbers the images (0, 1, ...) or lists them.
std::vector<std::string> images_in(const ZarrPlace& group)
{
    const ZarrPlace listing = group / "OME";
    const std::optional<ZarrNode> node =
        listing.has("zarr.json") || listing.has(".zattrs") ? read_zarr_node(listing) : std::nullopt;
    std::vector<std::string> images;
    if (node && node->ome()["series"].exists()) {
        constexpr size_t MAX_SERIES = 4096;
        for (const JsonNode& path : node->ome()["series"].elements(1, MAX_SERIES))
            images.push_back(read_zarr_path(path));
        return images;
    }
    for (const char* const name : {"0", "1"}) {
        const ZarrPlace inner = group / name;
        if (inner.has(".zattrs") || inner.has("zarr.json")) images.emplace_back(name);
    }
    return images;
}

std::unique_ptr<VolumeSource> open_group(const ZarrPlace& place, const ZarrNode& node, const OpenOptions& options)
{
    const JsonNode attributes = node.ome();
    const fs::path folder = place.path_of("");
    if (attributes["plate"].exists() || attributes["well"].exists()) {
        fail(folder.string(), ": is a plate of many images; expected one of them, for example ",
             (folder / (attributes["plate"].exists() ? "A/1/0" : "0")).string());
    }
    const std::vector<std::string> images = images_in(place);
    if (images.empty()) {
        fail(node.document.origin(), ": key ", node.version == 2 ? "" : "attributes.ome.",
             "multiscales is missing; expected an OME-Zarr image, or one of its arrays");
    }
    if (images.size() > 1) {
        fail(folder.string(), ": holds several images; expected one of them, for example ",
             (folder / images[0]).string());
    }
    const ZarrPlace inner = place / images[0];
    const std::optional<ZarrNode> image = read_zarr_node(inner);
    if (!image) fail(inner.path_of("").string(), ": is neither group nor array; expected an OME-Zarr image");
    return open_image(inner, *image, options);
}

/// Refuses an archive that is no image. The message states the probable mistake: the folder was zipped instead of its
/// content, or the archive holds something else.
[[noreturn]] void refuse_archive(const fs::path& path, const ZarrPlace& place)
{
    std::string first;
    const bool has_no_zarr = place.prefix.empty() && place.store->list({}, [&](std::string_view key) {
        if (first.empty()) first = key;
        const std::string_view name = key.substr(key.rfind('/') + 1);
        return name != "zarr.json" && name != ".zattrs" && name != ".zgroup" && name != ".zarray";
    });
    if (has_no_zarr && !first.empty())
        fail(path.string(), ": has no zarr.json at its root; it holds ", in_quotes(first),
             " and no OME-Zarr: unpack it, and open what is in it");
    fail(path.string(), ": has no zarr.json ", place.prefix.empty() ? "at its root" : "here",
         "; expected a zipped OME-Zarr: zip the content of its folder, not the folder");
}

/// Says why there is no OME-Zarr at an address, and what to do if a file seems to be there.
[[noreturn]] void refuse_address(const fs::path& path)
{
    for (const fs::path& part : path) {
        const std::string extension = lower_case(part.extension().string());
        if (extension == ".ozx" || extension == ".zip")
            fail(path.string(),
                 ": archives are not read over a network; expected the address of an OME-Zarr folder: unpack the "
                 "archive on the server, or download it and open the file");
    }
    fail(path.string(),
         ": has no zarr.json, .zattrs, .zgroup or .zarray; expected the address of an OME-Zarr, the only format that "
         "is read over a network: download other files, and open them here");
}

}  // namespace

std::unique_ptr<VolumeSource> open_ome_zarr(const fs::path& path, const OpenOptions& options)
{
    const std::optional<ZarrPlace> place = zarr_place(path);
    return place ? open_ome_zarr_at(*place, path, options) : nullptr;
}

std::unique_ptr<VolumeSource> open_ome_zarr_at(const ZarrPlace& place, const fs::path& path, const OpenOptions& options)
{
    const std::optional<ZarrNode> node = read_zarr_node(place);
    std::error_code ignored;
    if (!node && fs::is_directory(path, ignored)) return nullptr;
    if (!node && place.store->is_remote()) refuse_address(path);
    if (!node) refuse_archive(path, place);
    if (node->is_array) return open_array(place, node->version, options);
    check_ome_version(*node);
    if (node->ome()["multiscales"].exists()) return open_image(place, *node, options);
    return open_group(place, *node, options);
}

}  // namespace shvr
