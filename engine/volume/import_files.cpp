#include "engine/volume/import_files.h"

#include <sys/stat.h>

#include <algorithm>

#include <nlohmann/json.hpp>

#include "engine/volume/import_pyramid.h"
#include "engine/volume/ome_zarr.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Another layout of what an import writes, or of its state.
constexpr int LAYOUT = 2;

/// The array's order: z, y, x.
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

/// The file and what bears its name beside it (headers lead to other files), or what the folder holds.
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

std::string import_attributes(const std::string& name, const VolumeInfo& info, int levels, Halving how)
{
    Json datasets = Json::array();
    for (int level = 0; level < levels; ++level) {
        const double factor = static_cast<double>(int64_t{1} << level);
        // The centre of voxel 0, which is the middle of the voxels it stands for. Turned axes have no place here.
        glm::dvec3 translation = 0.5 * (factor - 1.0) * info.spacing;
        if (info.directions == glm::dmat3(1.0)) translation += info.origin;
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
    if (how == Halving::label) attributes["image-label"] = {{"version", "0.4"}};
    return attributes.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
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
        {"halving", static_cast<int>(options.halving)},
        {"sigma", list(options.preparation.blur_sigma_voxels)},
        {"compressor",
         {static_cast<int>(options.compressor.kind), options.compressor.codec, options.compressor.level,
          options.compressor.shuffle}}};
    return document.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace shvr
