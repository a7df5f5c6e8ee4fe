#pragma once
// What a disk may hold after the power was cut: of the data of a file, what was synced, and of what came later any
// part, in pieces of 512 bytes, in any order; of a folder's entries, those that were synced, and any of the later ones.
// After SQLite's crash tests: what a file system promises, and no more.

#include <map>
#include <random>
#include <span>
#include <string>

#include "tests/durability/watched_calls.h"

namespace shvr::test {

/// Files by path.
using Disk = std::map<std::string, std::string>;

struct PowerCut {
    size_t calls = 0;         ///< that were made before
    bool syncs_count = true;  ///< false: a disk that lies about syncing, to see a proof fail
};
Disk disk_after(std::span<const FileCall> calls, const PowerCut& cut, std::mt19937& random);

}  // namespace shvr::test
