#include "engine/projects/import_files.h"

#include <sys/stat.h>

#include <algorithm>

#include <nlohmann/json.hpp>

#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "engine/formats/zarr/ome_place.h"
#include "engine/formats/zarr/ome_zarr.h"
#include "engine/formats/zarr/project.h"
#include "engine/formats/zarr/zarr_json.h"
#include "engine/projects/import_pyramid.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Increment when the layout of an import's files or of its state changes.
constexpr int LAYOUT = 3;

/// In the array's order: z, y, x.
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

/// https://ngff.openmicroscopy.org/0.4/#label-md
void describe_labels(const LabelImage& labels, Json& attributes)
{
    Json& label = attributes["image-label"];
    Json colors = Json::array(), properties = Json::array();
    for (const LabelImage::Color& color : labels.colors) {
        colors.push_back({{"label-value", color.value}, {"rgba", color.rgba}});
        if (!color.name.empty()) properties.push_back({{"label-value", color.value}, {"name", color.name}});
    }
    if (!colors.empty()) label["colors"] = colors;
    if (!properties.empty()) label["properties"] = properties;
    if (!labels.source.empty()) label["source"] = {{"image", labels.source}};
    if (!labels.painted_on.empty()) attributes["shvr"] = {{"shvr_mask", 1}, {"image", labels.painted_on}};
}

/// The attributes in IMAGE/labels/.zattrs; empty if there is no such file.
Json listed_labels(const fs::path& folder)
{
    std::error_code ignored;
    const fs::path file = folder / ".zattrs";
    if (!fs::exists(file, ignored)) return Json::object();
    const JsonDocument attributes = read_zarr_json(file, LARGEST_ZARR_ATTRIBUTES);
    const JsonNode names = attributes.root()["labels"];
    if (names.exists() && !names.is_array()) names.refuse("a list of names");
    return attributes.value();
}

/// The file and the files beside it with the same stem (headers refer to other files), or the content of the folder.
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

ZarrVolume import_level(const fs::path& project, const VolumeInfo& info, int level, const ZarrCompressor& compressor)
{
    const Size3 size = size_of_level(info.size, level);
    ZarrMetadata metadata{.shape = {size.z, size.y, size.x},
                          .chunks = {IMPORT_CHUNK, IMPORT_CHUNK, IMPORT_CHUNK},
                          .type = info.type,
                          .separator = '/',
                          .compressor = compressor};
    return {project / std::to_string(level), std::move(metadata), ZarrView{}};
}

std::string import_group()
{
    return Json({{"zarr_format", 2}}).dump(4) + "\n";
}

std::string import_attributes(const std::string& name, const VolumeInfo& info, int levels, Halving how,
                              const LabelImage* labels)
{
    Json datasets = Json::array();
    for (int level = 0; level < levels; ++level) {
        const double factor = double(int64_t{1} << level);
        // The centre of voxel 0, which is the middle of the voxels it covers.
        const glm::dvec3 translation = ome_translation(info) + 0.5 * (factor - 1.0) * info.spacing;
        datasets.push_back({{"path", std::to_string(level)},
                            {"coordinateTransformations",
                             {{{"type", "scale"}, {"scale", zyx(factor * info.spacing)}},
                              {{"type", "translation"}, {"translation", zyx(translation)}}}}});
    }
    const Json axes = {axis_named("z", info.unit), axis_named("y", info.unit), axis_named("x", info.unit)};
    const Json multiscale = {
        {"version", "0.4"},
        {"name", name},
        {"axes", axes},
        {"datasets", datasets},
        {"type", how == Halving::label ? "mode" : "mean"},
        {"metadata",
         {{"description", sentence("each voxel is the ", how == Halving::label ? "most frequent" : "mean",
                                   " of the 2 x 2 x 2 voxels of the level before that there are")}}}};
    Json attributes = {{"multiscales", Json::array({multiscale})}};
    if (states_place(info)) {
        const auto list = [](const glm::dvec3& v) { return Json{v.x, v.y, v.z}; };
        attributes[OME_PLACEMENT] = {
            {"frame", info.frame},
            {"directions", {list(info.directions[0]), list(info.directions[1]), list(info.directions[2])}},
            {"origin", list(info.origin)}};
    }
    if (how == Halving::label) attributes["image-label"] = {{"version", "0.4"}};
    if (labels != nullptr) describe_labels(*labels, attributes);
    return attributes.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

fs::path label_image_target(const fs::path& folder)
{
    fs::path target = fs::absolute(folder).lexically_normal();
    if (!target.has_filename()) target = target.parent_path();
    std::error_code error;
    if (fs::exists(target, error) && !(fs::is_directory(target, error) && fs::is_empty(target, error))) {
        const fs::path file = target / ".zattrs";
        const bool is_label_image = fs::exists(file, error) && !fs::exists(target / PROJECT_RECORD, error) &&
                                    read_zarr_json(file, LARGEST_ZARR_ATTRIBUTES).root()["image-label"].exists();
        if (!is_label_image)
            fail(target.string(), ": is there already and is no label image; expected a new name, or one to replace");
    }
    if (belongs_to_image(target)) static_cast<void>(listed_labels(target.parent_path()));
    fs::create_directories(target.parent_path(), error);
    if (error) fail(target.parent_path().string(), ": cannot be made: ", error.message());
    return target;
}

bool belongs_to_image(const fs::path& target)
{
    const fs::path labels = target.parent_path();
    std::error_code ignored;
    return labels.filename() == "labels" && fs::exists(labels.parent_path() / ".zattrs", ignored);
}

void list_label_image(const fs::path& target)
{
    const fs::path folder = target.parent_path();
    Json attributes = listed_labels(folder);
    Json& names = attributes["labels"];
    const std::string name = target.filename().string();
    if (names.is_null()) names = Json::array();
    if (std::ranges::find(names, Json(name)) != names.end()) return;
    names.push_back(name);
    const std::string group = import_group();
    write_file_atomically(folder / ".zgroup", std::as_bytes(std::span(group)));
    const std::string text = attributes.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
    write_file_atomically(folder / ".zattrs", std::as_bytes(std::span(text)));
}

std::string import_session()
{
    const Json document = {{"shvr_session", 1}, {"volume", {{"path", ".."}}}, {"annotation", {{"mask", "paint.mask"}}}};
    return document.dump(2) + "\n";
}

std::string import_identity(const VolumeSource& source, const fs::path& origin, const ImportOptions& options)
{
    const VolumeInfo& info = source.info();
    const auto list = [](const auto& vector) { return Json{vector.x, vector.y, vector.z}; };
    const Json document = {
        {"layout", LAYOUT},
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
          options.compressor.shuffle}}};
    return document.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace shvr
