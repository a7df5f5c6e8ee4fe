#include "engine/formats/zip/zip_archive.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <climits>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {
namespace {

constexpr uint64_t HEADER_BYTES = 30;  ///< size of a local header, without name and extra fields
constexpr uint32_t HEADER_MARK = 0x04034b50;
/// Maximum number of bytes that one byte of deflate can decode to (zlib's technical notes).
constexpr uint64_t MAX_OUT_OF_A_BYTE = 1032;

FileDescriptor opened(const std::filesystem::path& path)
{
    // Without O_NONBLOCK, opening a FIFO would block until a writer appears.
    FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!file) fail(path.string(), ": cannot be opened: ", reason_of(errno));
    return file;
}

uint64_t bytes_of_file(const std::filesystem::path& path, int descriptor)
{
    struct stat status {};
    if (::fstat(descriptor, &status) != 0) fail(path.string(), ": cannot be examined: ", reason_of(errno));
    if (!S_ISREG(status.st_mode)) fail(path.string(), ": is not a regular file; expected a zip archive");
    return uint64_t(status.st_size);
}

uint32_t crc_of(std::span<const std::byte> bytes)
{
    return uint32_t(::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// Owns a zlib stream for raw deflate data, which its destructor always ends.
struct RawInflater {
    z_stream stream{};
    bool is_ready = false;
    ~RawInflater()
    {
        if (is_ready) inflateEnd(&stream);
    }
};

void inflate_entry(const std::string& name, std::span<const std::byte> stored, std::span<std::byte> bytes)
{
    RawInflater inflater;
    inflater.is_ready = inflateInit2(&inflater.stream, -MAX_WBITS) == Z_OK;
    if (!inflater.is_ready) fail(name, ": cannot be inflated: zlib found no memory; expected more free memory");
    z_stream& stream = inflater.stream;
    // zlib's interface predates const.
    stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(stored.data()));
    stream.avail_in = static_cast<uInt>(stored.size());
    stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
    stream.avail_out = static_cast<uInt>(bytes.size());
    const int status = inflate(&stream, Z_FINISH);
    if (status != Z_STREAM_END || stream.avail_out > 0) {
        fail(name, ": cannot be inflated (", stream.msg != nullptr ? stream.msg : "its size differs", "); expected ",
             bytes.size(), " bytes, as the archive's directory says");
    }
}

}  // namespace

ZipArchive::ZipArchive(std::filesystem::path path) : path_(std::move(path)), file_(opened(path_))
{
    directory_ = read_zip_directory(path_.string(), bytes_of_file(path_, file_.number()),
                                    [this](uint64_t offset, std::span<std::byte> bytes) { read_at(offset, bytes); });
}

const ZipEntry* ZipArchive::find(std::string_view name) const
{
    const auto found = std::ranges::lower_bound(directory_.entries, name, {}, &ZipEntry::name);
    return found != directory_.entries.end() && found->name == name ? &*found : nullptr;
}

std::string ZipArchive::name_of(const ZipEntry& entry) const
{
    return printable((path_ / entry.name).string());
}

void ZipArchive::read_at(uint64_t offset, std::span<std::byte> bytes) const
{
    while (!bytes.empty()) {
        const ssize_t count = ::pread(file_.number(), bytes.data(), bytes.size(), off_t(offset));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path_.string(), ": cannot be read: ", reason_of(errno));
        if (count == 0) fail(path_.string(), ": ends at byte ", offset, "; expected ", bytes.size(), " bytes more");
        bytes = bytes.subspan(size_t(count));
        offset += uint64_t(count);
    }
}

/// Returns the offset of the entry's stored bytes. Fails unless all of them lie before the directory.
uint64_t ZipArchive::data_of(const ZipEntry& entry) const
{
    const std::string name = name_of(entry);
    if ((entry.flags & ZIP_ENCRYPTED) != 0)
        fail(name, ": is encrypted; expected no encryption: make the archive without a password");
    if (entry.method != ZIP_STORED && entry.method != ZIP_DEFLATED)
        fail(name, ": is compressed with zip method ", entry.method,
             "; expected 0 (stored) or 8 (deflated): make the archive without compression");
    const uint64_t end = directory_.offset;
    const bool has_header = entry.header <= end && end - entry.header >= HEADER_BYTES + entry.name.size();
    std::vector<char> header;
    if (has_header) {
        header.resize(HEADER_BYTES + entry.name.size());
        read_at(entry.header, std::as_writable_bytes(std::span(header)));
    }
    if (!has_header || little_endian<uint32_t>(header.data()) != HEADER_MARK ||
        little_endian<uint16_t>(header.data() + 26) != entry.name.size() ||
        std::string_view(header.data() + HEADER_BYTES, entry.name.size()) != entry.name) {
        fail(name, ": has no header at byte ", entry.header,
             " of the archive; expected it there, as its directory says");
    }
    const uint64_t data = entry.header + header.size() + little_endian<uint16_t>(header.data() + 28);
    if (data > end || entry.stored_bytes > end - data) {
        fail(name, ": has ", entry.stored_bytes, " stored bytes at byte ", data,
             " as its directory says; expected them before the directory at byte ", end);
    }
    const bool is_possible = entry.method == ZIP_STORED ? entry.bytes == entry.stored_bytes
                                                        : entry.bytes / MAX_OUT_OF_A_BYTE <= entry.stored_bytes;
    if (!is_possible) {
        fail(name, ": has ", entry.stored_bytes, " stored bytes; expected enough for the ", entry.bytes,
             " that the archive's directory states");
    }
    return data;
}

std::vector<std::byte> ZipArchive::read(const ZipEntry& entry, int64_t max_bytes) const
{
    if (entry.bytes > uint64_t(max_bytes))
        fail(name_of(entry), ": holds ", entry.bytes, " bytes; expected at most ", max_bytes);
    const uint64_t data = data_of(entry);
    if (entry.stored_bytes > UINT_MAX || entry.bytes > UINT_MAX)
        fail(name_of(entry), ": holds ", entry.bytes, " bytes; expected less than 4 GiB");
    std::vector<std::byte> bytes(size_t(entry.bytes));
    if (entry.method == ZIP_STORED) {
        read_at(data, bytes);
    } else {
        std::vector<std::byte> stored(size_t(entry.stored_bytes));
        read_at(data, stored);
        inflate_entry(name_of(entry), stored, bytes);
    }
    if (const uint32_t found = crc_of(bytes); found != entry.crc) {
        fail(name_of(entry), ": is damaged: its CRC-32 is ", found, "; expected ", entry.crc,
             ", as the archive's directory says");
    }
    return bytes;
}

bool ZipArchive::is_plain(const ZipEntry& entry)
{
    return entry.method == ZIP_STORED;
}

void ZipArchive::read_part(const ZipEntry& entry, int64_t offset, std::span<std::byte> part) const
{
    const uint64_t data = data_of(entry);
    SHVR_CHECK(is_plain(entry) && offset >= 0 && uint64_t(offset) <= entry.bytes &&
                   part.size() <= entry.bytes - uint64_t(offset),
               entry.name, " ", offset, " ", part.size());
    read_at(data + uint64_t(offset), part);
}

}  // namespace shvr
