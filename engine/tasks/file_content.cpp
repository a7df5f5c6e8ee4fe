#include "engine/tasks/file_content.h"

#include <algorithm>
#include <fstream>

#include "engine/annotation/files/stated_content.h"
#include "engine/annotation/trace/trace_file.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/text.h"
#include "engine/formats/meshes/mesh_file.h"
#include "engine/session/picture_session.h"
#include "engine/session/session.h"

namespace shvr {

namespace fs = std::filesystem;

namespace {

constexpr int64_t MAX_JSON_BYTES = int64_t{16} << 20;
constexpr const char* LOADED = "a mask, density offsets, a trace, a transfer function or a mesh";
constexpr const char* EXPECTED =
    "; expected a volume, a session, a project, a mask, density offsets, a trace, a transfer function, a mesh or a "
    "picture that was made here";

/// Extensions of meshes in formats that are not read.
constexpr std::string_view OTHER_MESHES[] = {".gltf", ".dae", ".fbx", ".3ds", ".3mf", ".off", ".vtp", ".wrl", ".x3d"};

std::string first_bytes(const fs::path& path)
{
    std::string bytes(4096, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(bytes.data(), std::streamsize(bytes.size()));
    bytes.resize(size_t(std::max<std::streamsize>(file.gcount(), 0)));
    return bytes;
}

std::optional<FileContent> content_of_json(const fs::path& path)
{
    const JsonDocument document(read_text(path, MAX_JSON_BYTES), path.string());
    if (document.root()["shvr_session"].exists()) return FileContent::session;
    if (document.root()["shvr_look"].exists()) return FileContent::transfer_function;
    if (document.root()["points"].exists() || document.root()["preset"].exists()) return FileContent::transfer_function;
    return std::nullopt;
}

/// Recognises lines of the thesis's trace format and of SWC, since neither format has a magic number.
bool begins_like_a_trace(const std::string& begin)
{
    const size_t line = begin.find_first_not_of(" \t\r\n");
    if (line == std::string::npos) return false;
    const std::string_view rest = std::string_view(begin).substr(line);
    return rest.starts_with("-v ") || rest.starts_with("-l ") || rest.starts_with('#') ||
           (rest[0] >= '0' && rest[0] <= '9');
}

/// Returns the size in bytes of one voxel's offset in the thesis's format.
int64_t bytes_of_offset(VoxelType type)
{
    return bytes_of(type) == 1 ? 2 : 4;
}

std::optional<FileContent> content_of_bare(const fs::path& path, const VolumeInfo* open)
{
    if (open) {
        std::error_code ignored;
        const auto bytes = int64_t(fs::file_size(path, ignored));
        const int64_t voxels = voxel_count(*open);
        if (bytes == voxels) return FileContent::mask;
        if (bytes == voxels * bytes_of_offset(open->type)) return FileContent::offsets;
    }
    const std::string extension = lower_case(path.extension().string());
    if (extension == ".mask") return FileContent::mask;  // even if its size differs: the reader refuses it then
    if (extension == ".offset") return FileContent::offsets;
    return std::nullopt;
}

WhatItIs content_of_volume(const fs::path& path, const VolumeInfo* open)
{
    try {
        const UnmeasuredSession opened = open_unmeasured_session(path);
        if (const std::optional<StatedContent> stated = stated_content(path))
            return {.content = *stated == StatedContent::mask ? FileContent::mask : FileContent::offsets};
        const bool is_as_large = open && opened.source->info().size == open->size;
        if (is_as_large) return {.content = {}, .may_be_annotation = true};
        return {.content = FileContent::volume};
    } catch (const Error&) {
        if (const std::optional<FileContent> bare = content_of_bare(path, open)) return {.content = bare};
        throw;
    }
}

WhatItIs content_of(const fs::path& path, const VolumeInfo* open)
{
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) {
        if (!session_file_of(path).empty()) return {.content = FileContent::project};
        return content_of_volume(path, open);
    }
    if (std::ranges::find(OTHER_MESHES, lower_case(path.extension().string())) != std::end(OTHER_MESHES))
        fail(path.string(),
             ": is no mesh that can be read; expected .stl, .ply, .obj or .glb: export it as one of them");
    const std::string begin = first_bytes(path);
    const size_t first = begin.find_first_not_of(" \t\r\n");
    if (begin.starts_with("\x89PNG")) return {.content = FileContent::picture};
    if (begin.starts_with("II*") && session_in_picture(path)) return {.content = FileContent::picture};
    if (first != std::string::npos && begin[first] == '{') return {.content = content_of_json(path)};
    if (begin.find("<graphml") != std::string::npos || begin.find("<rsml") != std::string::npos)
        return {.content = FileContent::trace};
    if (is_trace_file(path) && begins_like_a_trace(begin)) return {.content = FileContent::trace};
    if (is_mesh_file(path)) return {.content = FileContent::mesh};
    return content_of_volume(path, open);
}

const char* name_of_opened(FileContent content)
{
    return content == FileContent::session   ? "a session"
           : content == FileContent::project ? "a project"
           : content == FileContent::picture ? "a picture"
                                             : "a volume";
}

}  // namespace

WhatItIs what_is(const fs::path& path, const VolumeInfo* open)
{
    try {
        const WhatItIs found = content_of(path, open);
        if (found.content || found.may_be_annotation) return found;
        return {.content = {}, .why_not = path.string() + ": is none of what can be taken" + EXPECTED};
    } catch (const Error& error) {
        return {.content = {}, .why_not = error.what()};
    }
}

WhatItIs what_annotation_is(const fs::path& path, const VolumeInfo& open)
{
    const auto refused = [](std::string why) { return WhatItIs{.content = {}, .why_not = std::move(why)}; };
    const WhatItIs found = what_is(path, &open);
    if (found.may_be_annotation) {
        const VoxelType type = open_unmeasured_session(path).source->info().type;
        const bool is_mask = type == VoxelType::uint8 || type == VoxelType::uint16 || type == VoxelType::uint32;
        return is_mask ? WhatItIs{.content = FileContent::mask} : found;
    }
    if (!found.content) return found;
    switch (*found.content) {
        case FileContent::mask:
        case FileContent::offsets:
        case FileContent::trace:
        case FileContent::mesh:
        case FileContent::transfer_function: return found;
        case FileContent::volume:
            return refused(sentence(
                path.string(), ": is a volume of ", digits_of(open_unmeasured_session(path).source->info().size),
                " voxels; expected annotation of ", digits_of(open.size), " voxels, the size of the open scan"));
        case FileContent::session:
        case FileContent::project:
        case FileContent::picture: break;
    }
    return refused(
        sentence(path.string(), ": is ", name_of_opened(*found.content), "; expected ", LOADED, "; Open opens it"));
}

std::string why_labels(const fs::path& path, const VolumeSource& source, const VolumeStatistics& statistics)
{
    if (!session_file_of(path).empty() || source.info().format == "procedural") return {};
    if (stated_content(path) == StatedContent::mask) return "it states that it is a mask";
    return labels_in_words(source, statistics);
}

}  // namespace shvr
