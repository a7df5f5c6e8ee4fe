#pragma once
// Writes one part of a document to its file, and preserves another program's file there. Any thread may call these.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/annotation/work/journal.h"
#include "engine/annotation/work/saved_files.h"
#include "engine/projects/import_sparse.h"

namespace shvr {

/// `journal`: its name (from `files`) and its last durable record are recorded with the mask; null if there is none.
/// Returns a message if, as `foreign` demands, the old image is kept under another name. If `progress` throws, the file
/// (or image) stays as it was.
std::string write_part(Part part, const Document& document, const WorkFiles& files,
                       const std::vector<LabelImage::Color>& looks, const Journal* journal, Foreign foreign,
                       const Progress& progress = {});

/// The inode number of a file or folder, by which a new file in its place is recognized; 0 if there is none.
uint64_t inode_of(const std::filesystem::path& path);

/// Keeps a file of another program that is about to be replaced: the constructor gives it a second name, `old_of`, so
/// that its content stays in the folder even if the process ends during the replacement.
class KeptFile {
public:
    /// Fails if the file can be neither linked nor copied. Does nothing if another process has moved the file.
    explicit KeptFile(const std::filesystem::path& path);
    /// Removes the second name again if the file was not replaced.
    ~KeptFile();
    KeptFile(const KeptFile&) = delete;
    KeptFile& operator=(const KeptFile&) = delete;
    /// The second name; null if the file was gone before it got one.
    const std::optional<std::filesystem::path>& old() const { return old_; }
    bool is_replaced() const;

private:
    std::filesystem::path path_;
    uint64_t inode_ = 0;
    std::optional<std::filesystem::path> old_;
};

}  // namespace shvr
