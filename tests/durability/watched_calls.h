#pragma once
// Every call with which this program changes files, seen and, where a test wants it, refused. The linker puts these in
// the place of the system's (-Wl,--wrap=...), so the product knows nothing of them and has no way around.
//
// One test at a time; calls may come from any thread.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace shvr::test {

struct FileCall {
    enum class Kind { create, write, truncate, sync, sync_folder, rename, unlink, note };
    Kind kind = Kind::note;
    std::string path, to;          ///< absolute; `to` of rename alone
    uint64_t at = 0;               ///< of write: where; of truncate: the new size; of note: its number
    std::vector<std::byte> bytes;  ///< of write
};

/// From now on calls about files below `folder` are kept.
void watch(const std::filesystem::path& folder);
/// An entry of the test's own among them.
void note(uint64_t number);
std::vector<FileCall> stop_watching();

/// What happens to a call: 0, or the number of the error that it fails with. SHORT_WRITE: writes half of the bytes.
constexpr int SHORT_WRITE = -1;
using Refusal = std::function<int(const FileCall&)>;
/// For calls about files below `folder`. An empty one refuses nothing.
void refuse_calls(const std::filesystem::path& folder, Refusal refusal);

}  // namespace shvr::test
