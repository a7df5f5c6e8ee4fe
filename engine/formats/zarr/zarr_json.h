#pragma once
// Reading the small JSON files of Zarr with words for what does not fit. They come from strangers: size and depth are
// bounded. For the zarr_*.cpp and *ome_zarr*.cpp files only. Any thread.

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace shvr {

/// Files of metadata are small; attributes may hold what other programs keep there.
inline constexpr int64_t LARGEST_ZARR_METADATA = int64_t{1} << 20;
inline constexpr int64_t LARGEST_ZARR_ATTRIBUTES = int64_t{4} << 20;

/// The object in a file. Fails where it is no valid JSON, no object, or nested more than 64 deep.
nlohmann::json read_json_object(const std::filesystem::path& path, int64_t max_bytes);

/// A value as it stands in messages: at most 60 characters, printable.
std::string shown(const nlohmann::json& value);

/// "PATH: KEY is VALUE; expected EXPECTED"
[[noreturn]] void refuse_json(const std::filesystem::path& path, const std::string& key, const nlohmann::json& value,
                              const std::string& expected);

/// The member, which must be there.
const nlohmann::json& required(const std::filesystem::path& path, const nlohmann::json& object, const char* key,
                               const std::string& expected);

}  // namespace shvr
