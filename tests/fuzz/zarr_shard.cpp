// A shard of Zarr version 3, of 2 x 2 x 2 chunks of 2 x 2 x 2 voxels. The first byte says where its index is, in which
// byte order, how chunks are encoded, and whether the index is given a checksum that holds.

#include <cstring>

#include "engine/formats/zarr/crc32c.h"
#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    constexpr size_t INDEX_BYTES = 8 * 16, CHECKSUM_BYTES = 4;
    if (size == 0) return 0;
    const unsigned choice = data[0];
    const bool is_first = (choice & 1) != 0, is_signed = (choice & 4) == 0;
    std::string shard(text_of({data + 1, size - 1}));
    if (is_signed && shard.size() >= INDEX_BYTES + CHECKSUM_BYTES) {
        const size_t index = is_first ? 0 : shard.size() - INDEX_BYTES - CHECKSUM_BYTES;
        const uint32_t checksum = crc32c(std::as_bytes(std::span(shard).subspan(index, INDEX_BYTES)));
        std::memcpy(shard.data() + index + INDEX_BYTES, &checksum, CHECKSUM_BYTES);
    }
    constexpr const char* CODECS[] = {"", R"(,{"name":"zstd"})", R"(,{"name":"crc32c"})", R"(,{"name":"gzip"})"};
    const std::string metadata =
        std::string(R"({"zarr_format":3,"node_type":"array","shape":[3,4,4],"data_type":"uint16","fill_value":7,)") +
        R"("chunk_grid":{"name":"regular","configuration":{"chunk_shape":[4,4,4]}},"chunk_key_encoding":"default",)" +
        R"("codecs":[{"name":"sharding_indexed","configuration":{"chunk_shape":[2,2,2],"index_location":")" +
        (is_first ? "start" : "end") + R"(","codecs":[{"name":"bytes","configuration":{"endian":"little"}})" +
        CODECS[choice >> 3 & 3] + R"(],"index_codecs":[{"name":"bytes","configuration":{"endian":")" +
        ((choice & 2) != 0 ? "big" : "little") + R"("}},{"name":"crc32c"}]}}]})";
    const InputFolder& folder = input_folder();
    folder.clear();
    folder.write("scan.zarr/zarr.json", metadata);
    folder.write("scan.zarr/c/0/0/0", shard);
    try_volume(folder.path() / "scan.zarr");
    return 0;
}
