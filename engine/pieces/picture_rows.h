#pragma once
// Rows of a picture in linear light, in a file: the piece of a task that draws a band of a picture. One thread.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/atomic_writer.h"
#include "engine/base/image_file.h"

namespace shvr {

/// Describes the rows and how they were drawn.
struct PictureRows {
    int64_t width = 0, height = 0;  ///< size of the whole picture
    int64_t lower = 0, upper = 0;   ///< rows in this file
    std::string device;             ///< name and driver: others may round differently
    bool is_complete = true;
    std::vector<std::string> warnings{};
    PictureTexts texts{};  ///< to be stored in the picture
};

class PictureRowsWriter {
public:
    /// The file appears once `commit` is called.
    explicit PictureRowsWriter(const std::filesystem::path& path) : file_(path) {}
    /// Adds the next rows, as wide as the picture.
    void add(const ImageF& rows);
    void commit(const PictureRows& description);

private:
    AtomicWriter file_;
};

/// Fails with a sentence if the file is not what PictureRowsWriter writes.
PictureRows read_rows_description(const std::filesystem::path& file);
/// Passes the rows on, a few at a time.
void read_rows(const std::filesystem::path& file, const PictureRows& description,
               const std::function<void(const ImageF& rows)>& take);

}  // namespace shvr
