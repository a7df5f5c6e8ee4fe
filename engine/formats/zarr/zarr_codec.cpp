#include "engine/formats/zarr/zarr_codec.h"

#include <blosc.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "engine/base/error.h"
#include "engine/formats/zarr/crc32c.h"

namespace shvr {
namespace {

constexpr size_t CHECKSUM_BYTES = 4;

using Bytes = std::span<const std::byte>;

[[noreturn]] void refuse_size(const std::string& name, const char* what, uint64_t found, uint64_t expected)
{
    fail(name, ": ", what, " ", found, " bytes; expected ", expected, " for the voxels of a chunk");
}

void decompress_blosc(Bytes stored, std::span<std::byte> chunk, const std::string& name)
{
    if (stored.size() < BLOSC_MIN_HEADER_LENGTH) {
        fail(name, ": holds ", stored.size(), " bytes; expected a blosc header of ", BLOSC_MIN_HEADER_LENGTH);
    }
    // Checks the header's values before `blosc_cbuffer_validate`, which trusts any values that are consistent.
    size_t bytes = 0, stored_bytes = 0, block_bytes = 0;
    blosc_cbuffer_sizes(stored.data(), &bytes, &stored_bytes, &block_bytes);
    if (stored_bytes != stored.size()) {
        fail(name, ": holds ", stored.size(), " bytes; expected ", stored_bytes, ", as its blosc header says");
    }
    if (bytes != chunk.size()) refuse_size(name, "its blosc header states", bytes, chunk.size());
    if (blosc_cbuffer_validate(stored.data(), stored.size(), &bytes) != 0 || bytes != chunk.size()) {
        fail(name, ": has a blosc header that contradicts itself; expected a complete chunk");
    }
    // Uses one thread, because several chunks are already decoded in parallel.
    const int made = blosc_decompress_ctx(stored.data(), chunk.data(), chunk.size(), 1);
    if (made < 0 || size_t(made) != chunk.size()) {
        fail(name, ": cannot be decoded by blosc (error ", made, "); expected a complete chunk");
    }
}

void decompress_zstd(Bytes stored, std::span<std::byte> chunk, const std::string& name)
{
    const size_t made = ZSTD_decompress(chunk.data(), chunk.size(), stored.data(), stored.size());
    if (ZSTD_isError(made) != 0) {
        fail(name, ": cannot be decoded by zstd (", ZSTD_getErrorName(made), "); expected ", chunk.size(), " bytes");
    }
    if (made != chunk.size()) refuse_size(name, "decodes to", made, chunk.size());
}

/// Owns a zlib stream, which its destructor always ends.
struct Inflater {
    z_stream stream{};
    bool is_ready = false;
    ~Inflater()
    {
        if (is_ready) inflateEnd(&stream);
    }
};

/// Decodes deflate data in a zlib or gzip wrapper. gzip data may consist of several members, one after the other.
void decompress_deflate(Bytes stored, std::span<std::byte> chunk, const std::string& name)
{
    Inflater inflater;
    constexpr int ZLIB_OR_GZIP = 32 + MAX_WBITS;
    inflater.is_ready = inflateInit2(&inflater.stream, ZLIB_OR_GZIP) == Z_OK;
    if (!inflater.is_ready) fail(name, ": cannot be decoded: zlib found no memory; expected more free memory");
    z_stream& stream = inflater.stream;
    // zlib's interface predates const.
    stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(stored.data()));
    stream.avail_in = static_cast<uInt>(stored.size());
    stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
    stream.avail_out = static_cast<uInt>(chunk.size());
    int status = Z_OK;
    while (status == Z_OK) {
        status = inflate(&stream, Z_FINISH);
        const bool has_more = status == Z_STREAM_END && stream.avail_in > 0 && stream.avail_out > 0;
        if (has_more) status = inflateReset(&stream);
    }
    const size_t made = chunk.size() - stream.avail_out;
    if (status == Z_BUF_ERROR && stream.avail_out == 0) {
        fail(name, ": decodes to more than ", made, " bytes; expected ", chunk.size(), " for the voxels of a chunk");
    }
    if (status != Z_STREAM_END) {
        fail(name, ": cannot be decoded by zlib (", stream.msg != nullptr ? stream.msg : "it ends too early",
             "); expected ", chunk.size(), " bytes");
    }
    if (made != chunk.size()) refuse_size(name, "decodes to", made, chunk.size());
}

/// Does what check_stored_size() does, for one compressor and without the bytes of checksums.
void check_compressed_size(ZarrCompressor::Kind kind, size_t stored_bytes, size_t chunk_bytes, const std::string& name)
{
    if (kind == ZarrCompressor::Kind::none) {
        if (stored_bytes != chunk_bytes) refuse_size(name, "holds", stored_bytes, chunk_bytes);
        return;
    }
    // Maximum expansion. Deflate: 258 bytes from two bits. Zstd, also inside blosc: 128 KiB from a block of four bytes.
    const bool is_deflate = kind == ZarrCompressor::Kind::zlib || kind == ZarrCompressor::Kind::gzip;
    const size_t most_out_of_a_byte = is_deflate ? 1032 : 32768;
    if (chunk_bytes / most_out_of_a_byte > stored_bytes) {
        fail(name, ": holds ", stored_bytes, " bytes; expected enough for the ", chunk_bytes, " of a chunk");
    }
}

/// Summary of a chain of codecs: the compressor, if any, and the number of checksums before and after it.
struct Steps {
    ZarrCompressor::Kind kind = ZarrCompressor::Kind::none;
    size_t before = 0, after = 0;
};

Steps steps_of(std::span<const ZarrCompressor> codecs)
{
    Steps steps;
    for (const ZarrCompressor& codec : codecs) {
        if (codec.kind == ZarrCompressor::Kind::none) continue;
        const bool is_checksum = codec.kind == ZarrCompressor::Kind::crc32c;
        SHVR_CHECK(is_checksum || steps.kind == ZarrCompressor::Kind::none, codecs.size());
        if (!is_checksum) {
            steps.kind = codec.kind;
            std::swap(steps.before, steps.after);
        } else {
            ++steps.after;
        }
    }
    return steps;
}

}  // namespace

int64_t longest_stored(int64_t chunk_bytes)
{
    // Deflate, the worst case, adds five bytes per block of at least 16 KiB; 4096 covers headers and checksums.
    return chunk_bytes + chunk_bytes / 1024 + 4096;
}

void check_stored_size(std::span<const ZarrCompressor> codecs, size_t stored_bytes, size_t chunk_bytes,
                       const std::string& name)
{
    const Steps steps = steps_of(codecs);
    if (stored_bytes < CHECKSUM_BYTES * steps.after)
        fail(name, ": holds ", stored_bytes, " bytes; expected at least its checksum of ", CHECKSUM_BYTES);
    check_compressed_size(steps.kind, stored_bytes - CHECKSUM_BYTES * steps.after,
                          chunk_bytes + CHECKSUM_BYTES * steps.before, name);
}

Bytes without_checksum(Bytes stored, const std::string& name)
{
    if (stored.size() < CHECKSUM_BYTES)
        fail(name, ": holds ", stored.size(), " bytes; expected at least its checksum of ", CHECKSUM_BYTES);
    const Bytes content = stored.first(stored.size() - CHECKSUM_BYTES);
    uint32_t expected = 0;  // little-endian, like this machine
    std::memcpy(&expected, stored.data() + content.size(), CHECKSUM_BYTES);
    if (const uint32_t found = crc32c(content); found != expected)
        fail(name, ": is damaged: its CRC-32C is ", found, "; expected ", expected, ", which is stored with it");
    return content;
}

void decode_chunk(std::span<const ZarrCompressor> codecs, Bytes stored, std::span<std::byte> chunk,
                  const std::string& name)
{
    const Steps steps = steps_of(codecs);
    for (size_t i = 0; i < steps.after; ++i) stored = without_checksum(stored, name);
    if (steps.before == 0) return decompress_chunk(steps.kind, stored, chunk, name);
    std::vector<std::byte> content(chunk.size() + CHECKSUM_BYTES * steps.before);
    decompress_chunk(steps.kind, stored, content, name);
    Bytes rest = content;
    for (size_t i = 0; i < steps.before; ++i) rest = without_checksum(rest, name);
    std::memcpy(chunk.data(), rest.data(), chunk.size());
}

void decompress_chunk(ZarrCompressor::Kind kind, Bytes stored, std::span<std::byte> chunk, const std::string& name)
{
    switch (kind) {
        case ZarrCompressor::Kind::none:
            check_compressed_size(kind, stored.size(), chunk.size(), name);
            std::memcpy(chunk.data(), stored.data(), chunk.size());
            return;
        case ZarrCompressor::Kind::blosc: return decompress_blosc(stored, chunk, name);
        case ZarrCompressor::Kind::zstd: return decompress_zstd(stored, chunk, name);
        case ZarrCompressor::Kind::zlib:
        case ZarrCompressor::Kind::gzip: return decompress_deflate(stored, chunk, name);
        case ZarrCompressor::Kind::crc32c: break;
    }
    SHVR_CHECK(false, "a checksum is no compressor");
}

Bytes compress_chunk(const ZarrCompressor& compressor, Bytes chunk, size_t voxel_bytes, std::vector<std::byte>& memory)
{
    if (compressor.kind == ZarrCompressor::Kind::none) return chunk;
    SHVR_CHECK(compressor.kind == ZarrCompressor::Kind::blosc, int(compressor.kind));
    memory.resize(std::max(memory.size(), chunk.size() + BLOSC_MAX_OVERHEAD));
    const int made = blosc_compress_ctx(compressor.level, compressor.shuffle, voxel_bytes, chunk.size(), chunk.data(),
                                        memory.data(), memory.size(), compressor.codec.c_str(), 0, 1);
    SHVR_CHECK(made > 0, made, " ", compressor.codec);
    return Bytes(memory).first(size_t(made));
}

}  // namespace shvr
