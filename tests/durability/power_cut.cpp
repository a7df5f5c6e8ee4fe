#include "tests/durability/power_cut.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

namespace shvr::test {

namespace {

constexpr size_t SECTOR_BYTES = 512;

struct File {
    std::string synced;
    std::vector<const FileCall*> later;  ///< writes and truncations
};
using Folder = std::map<std::string, std::shared_ptr<File>>;

void apply_call(std::string& content, const FileCall& call)
{
    if (call.kind == FileCall::Kind::truncate) return content.resize(call.at);
    content.resize(std::max<size_t>(content.size(), call.at + call.bytes.size()));
    std::transform(call.bytes.begin(), call.bytes.end(), content.begin() + ptrdiff_t(call.at),
                   [](std::byte byte) { return char(byte); });
}

/// Applies all of a call, nothing, or some of its sectors.
void apply_some(std::string& content, const FileCall& call, std::mt19937& random)
{
    const auto fate = random() % 4;
    if (fate == 0) return;
    if (fate != 1 || call.kind == FileCall::Kind::truncate) return apply_call(content, call);
    for (size_t at = 0; at < call.bytes.size(); at += SECTOR_BYTES) {
        if (random() % 2 == 0) continue;
        FileCall piece{call.kind, {}, {}, call.at + at, {}};
        const size_t end = std::min(at + SECTOR_BYTES, call.bytes.size());
        piece.bytes.assign(call.bytes.begin() + ptrdiff_t(at), call.bytes.begin() + ptrdiff_t(end));
        apply_call(content, piece);
    }
}

/// Takes out all files in a folder; their names are within it.
Folder taken_from(Folder& files, const std::string& folder)
{
    Folder taken;
    const std::string prefix = folder + "/";
    for (auto file = files.lower_bound(prefix); file != files.end() && file->first.starts_with(prefix);) {
        taken[file->first.substr(prefix.size())] = file->second;
        file = files.erase(file);
    }
    return taken;
}

void put_into(Folder& files, const std::string& folder, const Folder& taken)
{
    for (const auto& [name, file] : taken) files[folder + "/" + name] = file;
}

void apply_entry(Folder& folder, const FileCall& call, const std::shared_ptr<File>& created)
{
    switch (call.kind) {
        case FileCall::Kind::create: folder[call.path] = created; return;
        case FileCall::Kind::unlink: folder.erase(call.path); return;
        case FileCall::Kind::make_folder:  // a folder of that name was removed before
            static_cast<void>(taken_from(folder, call.path));
            return;
        case FileCall::Kind::rename:
            if (folder.contains(call.path)) {
                folder[call.to] = folder[call.path];
                folder.erase(call.path);
            } else
                put_into(folder, call.to, taken_from(folder, call.path));
            return;
        case FileCall::Kind::link:
            if (folder.contains(call.path)) folder[call.to] = folder[call.path];
            return;
        case FileCall::Kind::exchange: {
            const Folder one = taken_from(folder, call.path), other = taken_from(folder, call.to);
            put_into(folder, call.path, other);
            put_into(folder, call.to, one);
            return;
        }
        default: return;
    }
}

}  // namespace

Disk disk_after(std::span<const FileCall> calls, const PowerCut& cut, std::mt19937& random)
{
    struct Entry {
        const FileCall* call;
        std::shared_ptr<File> created;
    };
    Folder now, synced;        // entries as programs see them, and as guaranteed on the disk
    std::vector<Entry> later;  // the changes between the two
    for (const FileCall& call : calls.first(cut.calls)) {
        switch (call.kind) {
            case FileCall::Kind::create:
            case FileCall::Kind::rename:
            case FileCall::Kind::exchange:
            case FileCall::Kind::make_folder:
            case FileCall::Kind::link:
            case FileCall::Kind::unlink:
                later.push_back({&call, call.kind == FileCall::Kind::create ? std::make_shared<File>() : nullptr});
                apply_entry(now, call, later.back().created);
                break;
            case FileCall::Kind::write:
            case FileCall::Kind::truncate: now.at(call.path)->later.push_back(&call); break;
            case FileCall::Kind::sync:
                if (!cut.syncs_count) break;
                for (const FileCall* change : now.at(call.path)->later) apply_call(now.at(call.path)->synced, *change);
                now.at(call.path)->later.clear();
                break;
            case FileCall::Kind::sync_all:
                if (!cut.syncs_count) break;
                for (const auto& [path, file] : now) {
                    for (const FileCall* change : file->later) apply_call(file->synced, *change);
                    file->later.clear();
                }
                [[fallthrough]];
            case FileCall::Kind::sync_folder:
                if (!cut.syncs_count) break;
                synced = now;
                later.clear();
                break;
            case FileCall::Kind::note: break;
        }
    }
    const auto share = random() % 3;  // lost entries: some, none, all
    for (const Entry& entry : later)
        if (share == 1 || (share == 0 && random() % 2 == 0)) apply_entry(synced, *entry.call, entry.created);
    Disk disk;
    for (const auto& [path, file] : synced) {
        std::string content = file->synced;
        for (const FileCall* change : file->later) apply_some(content, *change, random);
        disk[path] = content;
    }
    return disk;
}

}  // namespace shvr::test
