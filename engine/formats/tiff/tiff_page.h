#pragma once
// One page of a TIFF as libtiff sees it. libtiff is given a header that points at this page, so opening a page costs
// the same anywhere in the file. Pages share nothing but the file; each thread opens its own pages. libtiff's messages
// go into our error messages, never to the terminal.

#include <array>
#include <memory>

#include "engine/formats/tiff/tiff_file.h"

struct tiff;  // libtiff's TIFF

namespace shvr {

/// Maximum memory that libtiff may allocate at once to read a directory. Decoding may take `decoding_memory`.
inline constexpr int64_t DIRECTORY_MEMORY = int64_t{64} << 20;

class TiffPage {
public:
    /// `page` counts from 1 and is only used in messages. Fails if libtiff cannot read the directory, or would allocate
    /// more than `max_memory_bytes` at once.
    TiffPage(const TiffFile& file, uint64_t directory, size_t page, int64_t max_memory_bytes = DIRECTORY_MEMORY);
    TiffPage(const TiffPage&) = delete;
    ~TiffPage();

    ::tiff* handle() const { return handle_; }
    /// "scan.tif: page 3", for messages.
    std::string subject() const;
    /// Returns libtiff's last error message in printable form, or a generic message if there was none.
    std::string complaint() const;

    /// These return a field's single number or, if the field is missing, libtiff's default or else `fallback`.
    uint16_t number16(uint32_t tag, uint16_t fallback) const;
    uint32_t number32(uint32_t tag, uint32_t fallback) const;
    bool has(uint32_t tag) const;
    std::string text(uint32_t tag) const;

private:
    struct Access;  // passed to libtiff's callbacks

    const TiffFile& file_;
    size_t page_;
    std::unique_ptr<Access> access_;
    ::tiff* handle_ = nullptr;
};

}  // namespace shvr
