#include "engine/tasks/file_content.h"

#include <algorithm>
#include <fstream>

#include "engine/annotation/trace/trace_file.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/session/session.h"

namespace shvr {

namespace fs = std::filesystem;

namespace {

constexpr int64_t MAX_JSON_BYTES = int64_t{16} << 20;
constexpr const char* EXPECTED =
    "; expected a volume, a session, a project, a mask, density offsets, a trace, a transfer function or a picture "
    "that was made here";

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
    if (document.root()["points"].exists() || document.root()["preset"].exists()) return FileContent::transfer_function;
    return std::nullopt;
}

/// Lines of the thesis's traces and of SWC, which have no magic number.
bool begins_like_a_trace(const std::string& begin)
{
    const size_t line = begin.find_first_not_of(" \t\r\n");
    if (line == std::string::npos) return false;
    const std::string_view rest = std::string_view(begin).substr(line);
    return rest.starts_with("-v ") || rest.starts_with("-l ") || rest.starts_with('#') ||
           (rest[0] >= '0' && rest[0] <= '9');
}

/// Bytes of a voxel's offset in the thesis's format.
int64_t bytes_of_offset(VoxelType type)
{
    return bytes_of(type) == 1 ? 2 : 4;
}

std::optional<FileContent> content_of_bare(const fs::path& path, const VolumeInfo& open)
{
    std::error_code ignored;
    const auto bytes = int64_t(fs::file_size(path, ignored));
    const int64_t voxels = voxel_count(open);
    if (bytes == voxels) return FileContent::mask;
    if (bytes == voxels * bytes_of_offset(open.type)) return FileContent::offsets;
    return std::nullopt;
}

std::optional<FileContent> content_of(const fs::path& path, const VolumeInfo* open)
{
    std::error_code ignored;
    if (fs::is_directory(path, ignored))
        return session_file_of(path).empty() ? FileContent::volume : FileContent::project;
    const std::string begin = first_bytes(path);
    const size_t first = begin.find_first_not_of(" \t\r\n");
    if (begin.starts_with("\x89PNG")) return FileContent::picture;
    if (first != std::string::npos && begin[first] == '{') return content_of_json(path);
    if (begin.find("<graphml") != std::string::npos || begin.find("<rsml") != std::string::npos)
        return FileContent::trace;
    if (is_trace_file(path) && begins_like_a_trace(begin)) return FileContent::trace;
    try {
        static_cast<void>(open_unmeasured_session(path));
        return FileContent::volume;
    } catch (const Error&) {
        if (open)
            if (const std::optional<FileContent> bare = content_of_bare(path, *open)) return bare;
        throw;
    }
}

}  // namespace

WhatItIs what_is(const fs::path& path, const VolumeInfo* open)
{
    try {
        const std::optional<FileContent> content = content_of(path, open);
        if (content) return {content, {}};
        return {std::nullopt, path.string() + ": is none of what can be taken" + EXPECTED};
    } catch (const Error& error) {
        return {std::nullopt, error.what()};
    }
}

}  // namespace shvr
