#include "engine/projects/import_files.h"

#include <sys/stat.h>

#include <algorithm>
#include <random>

#include <nlohmann/json.hpp>

#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "engine/formats/zarr/ome_place.h"
#include "engine/formats/zarr/ome_zarr.h"
#include "engine/formats/zarr/project.h"
#include "engine/formats/zarr/store/zarr_json.h"
#include "engine/projects/levels/import_pyramid.h"
#include "engine/projects/part_folder.h"
#include "engine/remote/address.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Version of the layout of an import's files and state. Increment it when either changes.
constexpr int LAYOUT = 4;

/// Chunks per shard along each axis: 512 voxels, so that a scan of 2048^3 has 64 shards, with an index of 8 KiB each.
constexpr int64_t SHARD_CHUNKS = 8;

/// Returns the components in the order of array axes: z, y, x.
Json zyx(const glm::dvec3& vector)
{
    return {vector.z, vector.y, vector.x};
}

Json axis_named(const char* name, const std::string& unit)
{
    Json axis = {{"name", name}, {"type", "space"}};
    if (unit != "voxel") axis["unit"] = ome_unit(unit);
    return axis;
}

std::string signature_of(const fs::path& path)
{
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return {};
    return sentence(path.filename().string(), " ", status.st_size, " ", status.st_mtim.tv_sec, ".",
                    status.st_mtim.tv_nsec);
}

/// Follows https://ngff.openmicroscopy.org/0.5/#labels-md. SHVR's own attributes are stored next to those of OME-Zarr.
void describe_labels(const LabelImage& labels, Json& label, Json& attributes)
{
    Json colors = Json::array(), properties = Json::array();
    for (const LabelImage::Color& color : labels.colors) {
        colors.push_back({{"label-value", color.value}, {"rgba", color.rgba}});
        if (!color.name.empty()) properties.push_back({{"label-value", color.value}, {"name", color.name}});
    }
    if (!colors.empty()) label["colors"] = colors;
    if (!properties.empty()) label["properties"] = properties;
    if (!labels.source.empty()) label["source"] = {{"image", labels.source}};
    if (labels.header) attributes["shvr"]["nrrd_header"] = lines_of(*labels.header);
    if (labels.painted_on.empty()) return;
    Json& ours = attributes["shvr"];
    ours["shvr_mask"] = 1;
    ours["image"] = labels.painted_on;
    if (!labels.journal) return;
    // A file's name need not be valid UTF-8; invalid bytes are replaced.
    const Json name = Json::parse(Json(labels.journal->name).dump(-1, ' ', false, Json::error_handler_t::replace));
    ours["journal"] = {
        {"name", name}, {"record", labels.journal->record}, {"checksum", labels.journal->checksum_digits()}};
}

/// Returns the attributes of the group IMAGE/labels; empty if the group does not exist.
Json listed_labels(const fs::path& folder)
{
    const std::optional<ZarrNode> node = read_zarr_node(folder);
    if (!node || !node->attributes().exists()) return Json::object();
    const JsonNode names = node->ome()["labels"];
    if (names.exists() && !names.is_array()) names.refuse("a list of names");
    return node->version == 2 ? node->document.value() : node->document.value()["attributes"];
}

/// Fails if the existing list of label images is malformed, so that no image can be added.
void check_list_of_labels(const fs::path& folder)
{
    std::error_code ignored;
    if (fs::exists(folder, ignored) && !fs::is_directory(folder, ignored))
        fail(folder.string(),
             ": is a file; expected the folder of the image's labels: move the file, and the next save "
             "makes the folder");
    try {
        static_cast<void>(listed_labels(folder));
    } catch (const Error& error) {
        fail(error.what(), "; it lists the image's labels: repair it, or move it, and the next save writes a new list");
    }
}

OmeZarrVersion version_of(const ZarrNode& node)
{
    return node.version == 2 ? OmeZarrVersion::v0_4 : OmeZarrVersion::v0_5;
}

std::string text_of(const Json& document, int indent)
{
    return document.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// Returns signatures of a folder's files, or of a file and all files with its stem, since headers may refer to them.
Json signatures_of(const fs::path& origin)
{
    std::error_code ignored;
    const bool is_folder = fs::is_directory(origin, ignored);
    std::vector<std::string> found;
    for (const fs::directory_entry& entry :
         fs::directory_iterator(is_folder ? origin : origin.parent_path(), ignored)) {
        if (!is_folder && entry.path().stem() != origin.stem()) continue;
        if (is_folder && entry.is_directory(ignored)) continue;
        found.push_back(signature_of(entry.path()));
    }
    std::ranges::sort(found);
    return found;
}

}  // namespace

std::string LabelImage::Journal::checksum_digits() const
{
    std::string digits;
    for (int shift = 60; shift >= 0; shift -= 4) digits += "0123456789abcdef"[(checksum >> shift) & 15];
    return digits;
}

ZarrVolume import_level(const fs::path& project, const VolumeInfo& info, int level, OmeZarrVersion version,
                        const ZarrCompressor& compressor, bool has_shards, const FillVoxel& fill)
{
    const Size3 size = size_of_level(info.size, level);
    const bool is_3 = version == OmeZarrVersion::v0_5;
    SHVR_CHECK(is_3 || !has_shards);
    ZarrMetadata metadata{.version = is_3 ? 3 : 2,
                          .shape = {size.z, size.y, size.x},
                          .chunks = {IMPORT_CHUNK, IMPORT_CHUNK, IMPORT_CHUNK},
                          .type = info.type,
                          .fill = fill,
                          .has_prefix = is_3,
                          .separator = '/',
                          .codecs = {compressor},
                          .axes = {"z", "y", "x"}};
    const Size3 along = glm::min((size - int64_t{1}) / IMPORT_CHUNK + int64_t{1}, Size3(SHARD_CHUNKS));
    if (has_shards && along != Size3(1)) {
        const Size3 shard = along * IMPORT_CHUNK;
        metadata.sharding = ZarrSharding{.shape = {shard.z, shard.y, shard.x}, .order = {0, 1, 2}, .checksums = 1};
    }
    return {zarr_folder(project / std::to_string(level)), std::move(metadata), ZarrView{}};
}

std::vector<std::pair<std::string, std::string>> group_files(OmeZarrVersion version, const std::string& attributes)
{
    if (version == OmeZarrVersion::v0_4)
        return {{".zgroup", text_of({{"zarr_format", 2}}, 4)}, {".zattrs", attributes}};
    const Json group = {{"zarr_format", 3}, {"node_type", "group"}, {"attributes", Json::parse(attributes)}};
    return {{"zarr.json", text_of(group, 2)}};
}

std::string import_attributes(OmeZarrVersion version, const std::string& name, const VolumeInfo& info, int levels,
                              Halving how, const LabelImage* labels, const std::string& folder)
{
    const bool has_own_versions = version == OmeZarrVersion::v0_4;  // since OME-Zarr 0.5, one version for all
    Json datasets = Json::array();
    for (int level = 0; level < levels; ++level) {
        const double factor = double(int64_t{1} << level);
        // The centre of voxel 0 of a level is the centre of the voxels of level 0 that it covers.
        const glm::dvec3 translation = ome_translation(info) + 0.5 * (factor - 1.0) * info.spacing;
        datasets.push_back({{"path", folder + std::to_string(level)},
                            {"coordinateTransformations",
                             {{{"type", "scale"}, {"scale", zyx(factor * info.spacing)}},
                              {{"type", "translation"}, {"translation", zyx(translation)}}}}});
    }
    const Json axes = {axis_named("z", info.unit), axis_named("y", info.unit), axis_named("x", info.unit)};
    Json multiscale = has_own_versions ? Json{{"version", "0.4"}} : Json::object();
    multiscale.update(
        {{"name", name},
         {"axes", axes},
         {"datasets", datasets},
         {"type", how == Halving::label ? "mode" : "mean"},
         {"metadata",
          {{"description", sentence("each voxel is the ", how == Halving::label ? "most frequent" : "mean",
                                    " of the 2 x 2 x 2 voxels of the level before that there are")}}}});
    Json ome = has_own_versions ? Json::object() : Json{{"version", spelled(version)}};
    ome["multiscales"] = Json::array({multiscale});
    if (how == Halving::label) ome["image-label"] = {{"version", spelled(version)}};
    Json ours = Json::object();
    if (states_place(info)) {
        const auto list = [](const glm::dvec3& v) { return Json{v.x, v.y, v.z}; };
        ours[OME_PLACEMENT] = {
            {"frame", info.frame},
            {"directions", {list(info.directions[0]), list(info.directions[1]), list(info.directions[2])}},
            {"origin", list(info.origin)}};
    }
    if (labels != nullptr) describe_labels(*labels, ome["image-label"], ours);
    Json attributes = has_own_versions ? ome : Json{{"ome", ome}};
    attributes.update(ours);
    return text_of(attributes, 2);
}

std::string number_attributes(const std::string& name, const VolumeInfo& info, const std::string& kind,
                              const std::string& folder)
{
    Json attributes =
        Json::parse(import_attributes(OmeZarrVersion::v0_4, name, info, 1, Halving::mean, nullptr, folder));
    attributes["shvr"] = {{"shvr_" + kind, 1}};
    return text_of(attributes, 2);
}

fs::path number_image_target(const fs::path& folder, const std::string& kind, bool replaces_any)
{
    fs::path target = plain_path(folder);
    std::error_code ignored;
    if (replaces_any || !fs::exists(fs::symlink_status(target, ignored)) ||
        (fs::is_directory(target, ignored) && fs::is_empty(target, ignored)))
        return target;
    const std::optional<ZarrNode> node = read_zarr_node(target);
    const bool is_replaceable = node && node->attributes()["shvr"]["shvr_" + kind].exists();
    if (!is_replaceable)
        fail(target.string(), ": already exists and is no image of ", kind, "; expected a new name, or ", kind,
             " to replace");
    return target;
}

fs::path label_image_target(const fs::path& folder, bool replaces_any)
{
    const fs::path target = plain_path(folder);
    std::error_code error;
    if (!replaces_any && fs::exists(target, error) &&
        !(fs::is_directory(target, error) && fs::is_empty(target, error))) {
        const std::optional<ZarrNode> node = read_zarr_node(target);
        const bool is_label_image =
            node && !fs::exists(target / PROJECT_RECORD, error) && node->ome()["image-label"].exists();
        if (!is_label_image)
            fail(target.string(),
                 ": already exists and is not a label image; expected a new name, or a label image to replace");
    }
    if (belongs_to_image(target)) check_list_of_labels(target.parent_path());
    fs::create_directories(target.parent_path(), error);
    if (error) fail(target.parent_path().string(), ": cannot be created: ", error.message());
    return target;
}

bool belongs_to_image(const fs::path& target)
{
    const fs::path labels = target.parent_path();
    const fs::path image = labels.parent_path();
    std::error_code ignored;
    return labels.filename() == "labels" &&
           (fs::exists(image / ".zattrs", ignored) || fs::exists(image / "zarr.json", ignored));
}

OmeZarrVersion label_image_version(const fs::path& target, std::optional<OmeZarrVersion> wanted)
{
    const bool belongs = belongs_to_image(target);
    const fs::path other = belongs ? target.parent_path().parent_path() : target;
    const std::optional<ZarrNode> node = read_zarr_node(other);
    if (!node) return wanted.value_or(OmeZarrVersion::v0_4);
    const OmeZarrVersion found = version_of(*node);
    if (belongs && wanted && *wanted != found) {
        fail(other.string(), ": is an OME-Zarr ", spelled(found), ", and its labels were asked for as ",
             spelled(*wanted), "; expected one version for both: leave out --ome-zarr");
    }
    return belongs ? found : wanted.value_or(found);
}

void list_label_image(const fs::path& target, OmeZarrVersion version)
{
    const fs::path folder = target.parent_path();
    Json attributes = listed_labels(folder);
    const bool is_3 = version == OmeZarrVersion::v0_5;
    if (is_3) attributes["ome"]["version"] = spelled(version);
    Json& names = is_3 ? attributes["ome"]["labels"] : attributes["labels"];
    const std::string name = target.filename().string();
    if (names.is_null()) names = Json::array();
    if (std::ranges::find(names, Json(name)) != names.end()) return;
    names.push_back(name);
    for (const auto& [file, text] : group_files(version, text_of(attributes, 2)))
        write_file_atomically(folder / file, std::as_bytes(std::span(text)));
}

std::string import_session()
{
    const Json document = {
        {"shvr_session", 1},
        {"volume", {{"path", ".."}}},
        {"annotation", {{"mask", "../labels/paint"}, {"trace", "paint.graphml"}, {"density", "paint.offsets.zarr"}}}};
    return document.dump(2) + "\n";
}

std::string import_identity(const VolumeSource& source, const fs::path& origin, const ImportOptions& options,
                            const char* way, bool is_split)
{
    const VolumeInfo& info = source.info();
    const auto list = [](const auto& vector) { return Json{vector.x, vector.y, vector.z}; };
    Json document = {{"layout", LAYOUT},
                     {"way", way},
                     {"path", origin.string()},
                     {"files", signatures_of(origin)},
                     {"choice", options.choice},
                     {"size", list(info.size)},
                     {"type", name_of(info.type)},
                     {"spacing", list(info.spacing)},
                     {"unit", info.unit},
                     {"directions", {list(info.directions[0]), list(info.directions[1]), list(info.directions[2])}},
                     {"origin", list(info.origin)},
                     {"frame", info.frame},
                     {"warnings", info.warnings},
                     {"preparation", to_text(options.preparation)},
                     {"halving", int(options.halving)},
                     {"sigma", list(options.preparation.blur_sigma_voxels)},
                     {"compressor",
                      {int(options.compressor.kind), options.compressor.codec, options.compressor.level,
                       options.compressor.shuffle}},
                     {"version", sentence(spelled(options.version.value_or(OmeZarrVersion::v0_4)),
                                          options.has_shards ? " in shards" : "")}};
    if (leads_to_network(origin) && !is_split) document["once"] = {std::random_device{}(), std::random_device{}()};
    return document.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace shvr
