#pragma once
// Records, and on demand refuses, every call with which the program changes files. The linker substitutes these for the
// system's (-Wl,--wrap=...), so the program is unaware of them and cannot bypass them.
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
    enum class Kind {
        create,
        write,
        truncate,
        sync,
        sync_folder,
        sync_all,
        make_folder,
        rename,
        exchange,
        link,
        unlink,
        note
    };
    Kind kind = Kind::note;
    std::string path, to;          ///< absolute; `to` for rename, exchange and link only
    uint64_t at = 0;               ///< write: the offset; truncate: the new size; rename: flags; note: its number
    std::vector<std::byte> bytes;  ///< for write
};

/// From now on records calls on files below `folder`.
void watch(const std::filesystem::path& folder);
/// Adds a test's own entry to the record.
void note(uint64_t number);
std::vector<FileCall> stop_watching();

/// The fate of a call: 0 to make it, or the errno that it fails with. SHORT_WRITE: writes half of the bytes.
constexpr int SHORT_WRITE = -1;
using Refusal = std::function<int(const FileCall&)>;
/// For calls on files below `folder`. An empty function refuses nothing.
void refuse_calls(const std::filesystem::path& folder, Refusal refusal);

}  // namespace shvr::test
