// The state from which an interrupted import resumes: such a file or, after a "w", the content of one to be written.

#include "engine/projects/levels/import_state.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    folder.clear();
    const std::string_view text = text_of({data, size});
    if (text.starts_with('w')) {
        const std::string kept(text.substr(1));
        StateWriter writer;
        writer.put(kept);
        writer.put_all(std::vector<char>(kept.begin(), kept.end()));
        accepts([&] {
            writer.write(folder.path() / "state");
            StateReader reader(folder.path() / "state");
            expect(reader.take_text() == kept && reader.take().size() == kept.size(), "a changed state");
        });
        return 0;
    }
    const auto file = folder.write("state", text);
    accepts([&] {
        StateReader reader(file);
        for (int piece = 0; piece < 100; ++piece) reader.take();
    });
    return 0;
}
