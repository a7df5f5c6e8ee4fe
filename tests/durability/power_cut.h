#pragma once
// Possible contents of a disk after a power cut: all synced data of a file, and any part of the later writes, in pieces
// of 512 bytes, in any order; all synced entries of a folder, and any of the later ones. Modelled on SQLite's crash
// tests: only what file systems guarantee.

#include <map>
#include <random>
#include <span>
#include <string>

#include "tests/durability/watched_calls.h"

namespace shvr::test {

/// Files by path.
using Disk = std::map<std::string, std::string>;

struct PowerCut {
    size_t calls = 0;         ///< made before the power cut
    bool syncs_count = true;  ///< false: a disk that ignores syncs, to make a proof fail
};
Disk disk_after(std::span<const FileCall> calls, const PowerCut& cut, std::mt19937& random);

}  // namespace shvr::test
