#pragma once
// One page of a TIFF as libtiff sees it. libtiff is shown a file whose header points at that page, so opening a page
// costs the same wherever it lies, and nothing is shared between two of them but the file: each thread opens its own.
// What libtiff has to say goes into our sentences, never to the terminal.

#include <array>
#include <memory>

#include "engine/formats/tiff/tiff_file.h"

struct tiff;  // libtiff's TIFF

namespace shvr {

/// What libtiff may take at once to read a directory. Decoding needs more (`decoding_memory`).
inline constexpr int64_t DIRECTORY_MEMORY = int64_t{64} << 20;

class TiffPage {
public:
    /// `page` counts from 1 and is for messages. Fails where libtiff cannot read the directory, or would take more than
    /// `most_memory_bytes` at once.
    TiffPage(const TiffFile& file, uint64_t directory, size_t page, int64_t most_memory_bytes = DIRECTORY_MEMORY);
    TiffPage(const TiffPage&) = delete;
    ~TiffPage();

    ::tiff* handle() const { return handle_; }
    /// "scan.tif: page 3", for messages.
    std::string subject() const;
    /// libtiff's last complaint, fit to be shown; what to say where there was none.
    std::string complaint() const;

    /// Fields of one number, or libtiff's default for them.
    uint16_t number16(uint32_t tag, uint16_t fallback) const;
    uint32_t number32(uint32_t tag, uint32_t fallback) const;
    bool has(uint32_t tag) const;
    std::string text(uint32_t tag) const;

private:
    struct Access;  // what libtiff's callbacks are given

    const TiffFile& file_;
    size_t page_;
    std::unique_ptr<Access> access_;
    ::tiff* handle_ = nullptr;
};

}  // namespace shvr
