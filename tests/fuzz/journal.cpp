// A journal. The first byte gives the form of the rest: 0, the file's bytes; 1, records (kind 1, about 1, length 2,
// content) that get valid frames and checksums, so that their contents are parsed, too.

#include "engine/annotation/work/work.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

namespace {

using namespace shvr;

constexpr Size3 SIZE(40, 24, 24);

std::string framed_records(std::span<const std::byte> bytes)
{
    std::string file;
    const auto add = [&](std::span<const std::byte> more) {
        file.append(reinterpret_cast<const char*>(more.data()), more.size());
    };
    uint64_t checksum = 0;
    const auto add_record = [&](RecordKind kind, RecordNumber about, std::span<const std::byte> content) {
        JournalRecord record{.kind = kind, .label = "step", .about = about};
        add(framed(record, content, checksum));
    };
    add(journal_header());
    add_record(RecordKind::subject, 0, bytes_of(JournalSubject{SIZE, VoxelType::uint8, {}}));
    while (bytes.size() >= 4) {
        const auto length = std::min<size_t>(bytes.size() - 4, size_t(bytes[2]) + 256 * size_t(bytes[3]));
        add_record(RecordKind(bytes[0]), RecordNumber(bytes[1]), bytes.subspan(4, length));
        bytes = bytes.subspan(4 + length);
    }
    return file;
}

/// The state that a change is compared with before undo or redo. Selections and settings are left out: a state may lack
/// those of a step, and both are accepted.
std::vector<std::byte> held(Document document)
{
    document.settings = {};
    document.trace.select({});
    return bytes_of(document);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr::fuzz;
    if (size < 1) return 0;
    const auto rest = std::as_bytes(std::span(data, size)).subspan(1);
    const InputFolder& folder = input_folder();
    folder.clear();
    const std::string bytes = data[0] % 2 == 0 ? std::string(text_of({data + 1, size - 1})) : framed_records(rest);
    const WorkFiles files{.journal = folder.write("a.journal", bytes)};
    accepts([&] {
        std::vector<std::byte> state;
        {
            Work work(SIZE, VoxelType::uint8);
            work.open(files);
            state = held(work.document());
            const size_t undoable = work.history().undoable();
            passes([&] {
                for (size_t i = 0; i < undoable; ++i) work.undo();
                for (size_t i = 0; i < undoable; ++i) work.redo();
                expect(held(work.document()) == state, "a document that differs after all was undone and done again");
            });
            state = bytes_of(work.document());
        }
        Work again(SIZE, VoxelType::uint8);
        again.open(files);
        expect(bytes_of(again.document()) == state, "a document that is another after it was left and taken up again");
    });
    return 0;
}
