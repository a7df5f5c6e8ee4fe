// Session files: a session that is read, written and read again stays the same. The volume is opened if it is
// procedural or beside the session.

#include "engine/session/session.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    folder.clear();
    folder.write("scan_5x4x3_int16.raw", std::string(120, 'v'));
    Session session;
    const std::string text(text_of({data, size}));
    if (!accepts([&] { session = parse_session(text, folder.path(), "session"); })) return 0;

    const std::string written = to_text(session, folder.path());
    Session again;
    expect(passes([&] { again = parse_session(written, folder.path(), "session"); }),
           "a session that cannot be read once written: " + last_outcome().refusal);
    expect(to_text(again, folder.path()) == written, "a session that changes when it is written:\n" + written);

    bake_table(session.transfer_function, session.render.step_voxels, whole_range(session.transfer_function, 64));
    const VolumeInfo info{.size = Size3(5, 4, 3)};
    passes([&] { camera_named(session, "", info); });
    for (const auto& [name, camera] : session.cameras) {
        passes([&, &key = name] { camera_named(session, key, info); });
    }
    const bool is_beside = session.volume_path.parent_path() == folder.path();
    std::unique_ptr<VolumeSource> source;
    if (session.procedural || is_beside) passes([&] { source = open_source(session); });
    if (!source) return 0;
    try_source(*source);
    const Size3 volume = source->info().size;
    if (volume.x * volume.y > 4096 || volume.z > 64) return 0;
    const auto file = folder.write("a.session.json", text);
    passes([&] { open_session(file); });
    return 0;
}
