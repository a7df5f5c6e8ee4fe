#include "engine/projects/levels/import_state.h"

#include <xxhash.h>
#include <zstd.h>

#include <memory>

#include "engine/base/atomic_file.h"
#include "engine/base/file.h"

namespace shvr {
namespace {

constexpr char MAGIC[] = "SHVRIMP1";
constexpr size_t MAGIC_BYTES = 8;
constexpr size_t HEADER_BYTES = MAGIC_BYTES + 2 * sizeof(uint64_t);  ///< magic, length and hash of the content
constexpr int64_t MAX_STATE_BYTES = int64_t{1} << 40;
/// A block of Zstd has at least four bytes and decodes to at most 128 KiB, which limits the compression ratio.
constexpr uint64_t MAX_OUT_OF_A_BYTE = uint64_t{32} << 10;

}  // namespace

void StateWriter::put(std::span<const std::byte> piece)
{
    const uint64_t length = piece.size();
    const auto prefix = std::as_bytes(std::span(&length, 1));
    bytes_.insert(bytes_.end(), prefix.begin(), prefix.end());
    bytes_.insert(bytes_.end(), piece.begin(), piece.end());
}

void StateWriter::write(const std::filesystem::path& file) const
{
    std::vector<std::byte> content(HEADER_BYTES + ZSTD_compressBound(bytes_.size()));
    const uint64_t header[] = {bytes_.size(), XXH3_64bits(bytes_.data(), bytes_.size())};
    std::memcpy(content.data(), MAGIC, MAGIC_BYTES);
    std::memcpy(content.data() + MAGIC_BYTES, header, sizeof(header));
    const size_t made =
        ZSTD_compress(content.data() + HEADER_BYTES, content.size() - HEADER_BYTES, bytes_.data(), bytes_.size(), 1);
    SHVR_CHECK(ZSTD_isError(made) == 0, ZSTD_getErrorName(made));
    content.resize(HEADER_BYTES + made);
    write_file_atomically(file, content);
}

StateReader::StateReader(const std::filesystem::path& file) : file_(file)
{
    const std::vector<std::byte> content = read_file(file, MAX_STATE_BYTES);
    if (content.size() < HEADER_BYTES || std::memcmp(content.data(), MAGIC, MAGIC_BYTES) != 0) refuse();
    uint64_t header[2];
    std::memcpy(header, content.data() + MAGIC_BYTES, sizeof(header));
    const std::byte* const frame = content.data() + HEADER_BYTES;
    const size_t frame_bytes = content.size() - HEADER_BYTES;
    // Before memory is allocated, the length stated in the Zstd frame must equal that in the file's header.
    if (ZSTD_getFrameContentSize(frame, frame_bytes) != header[0] || header[0] > uint64_t{MAX_STATE_BYTES}) refuse();
    if (header[0] / MAX_OUT_OF_A_BYTE > frame_bytes) refuse();
    bytes_.resize(header[0]);
    const size_t made = ZSTD_decompress(bytes_.data(), bytes_.size(), frame, frame_bytes);
    if (made != bytes_.size() || XXH3_64bits(bytes_.data(), bytes_.size()) != header[1]) refuse();
}

std::span<const std::byte> StateReader::take()
{
    uint64_t length = 0;
    if (bytes_.size() - at_ < sizeof(length)) refuse();
    std::memcpy(&length, bytes_.data() + at_, sizeof(length));
    at_ += sizeof(length);
    if (bytes_.size() - at_ < length) refuse();
    const std::span<const std::byte> piece = std::span(bytes_).subspan(at_, length);
    at_ += length;
    return piece;
}

std::string StateReader::take_text()
{
    const std::span<const std::byte> piece = take();
    return {reinterpret_cast<const char*>(piece.data()), piece.size()};
}

void StateReader::refuse() const
{
    fail(file_.string(), ": is damaged, or of another version; expected the state of an interrupted import");
}

}  // namespace shvr
