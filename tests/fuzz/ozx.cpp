// A zip archive: what is in it as entries, and as an OME-Zarr.

#include "engine/formats/zip/zip_archive.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    folder.clear();
    const auto file = folder.write("scan.ozx", text_of({data, size}));
    passes([&] {
        const ZipArchive archive(file);
        constexpr int64_t MAX_BYTES = int64_t{1} << 20;
        for (const ZipEntry& entry : archive.entries()) {
            expect(archive.find(entry.name) == &entry, "an entry that is not found by its name");
            passes([&] {
                const std::vector<std::byte> bytes = archive.read(entry, MAX_BYTES);
                expect(bytes.size() == entry.bytes, "an entry of another size than its directory says");
                if (!ZipArchive::is_plain(entry) || bytes.size() < 2) return;
                std::byte last{};
                archive.read_part(entry, int64_t(bytes.size()) - 1, {&last, 1});
                expect(last == bytes.back(), "a part that is not that of the whole");
            });
        }
    });
    try_volume(file);
    return 0;
}
