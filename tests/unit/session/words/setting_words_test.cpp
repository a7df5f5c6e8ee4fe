#include "engine/session/words/setting_words.h"

#include <limits>

#include <doctest/doctest.h>

#include "engine/session/session_keys.h"
#include "engine/session/session_patch.h"
#include "engine/session/words/number_words.h"
#include "engine/session/words/setting_labels.h"

using namespace shvr;

namespace {

/// Describes the changes that the patch makes.
std::string words_of(const char* patch, const char* before = "{}")
{
    const Session was = patched(Session(), before);
    return difference_in_words(was, patched(was, patch));
}

}  // namespace

TEST_CASE("what differs between two sessions is told as what a person did, or by its section if it is much")
{
    CHECK(words_of("{}") == "");
    CHECK(words_of(R"({"light":{"ambient":0.5}})") == "set ambient light from 0.3 to 0.5");
    CHECK(words_of(R"({"light":{"ambient":0.5,"diffuse":0.6}})") ==
          "set ambient light from 0.3 to 0.5 and set diffuse light from 0.7 to 0.6");
    CHECK(words_of(R"({"light":{"ambient":0.5,"diffuse":0.6,"specular":0,"shininess":3}})") == "changed the light");
    CHECK(words_of(R"({"light":{"direction":[0,1,0]}})") == "set direction of the light from 0, 0, 0 to 0, 1, 0");
    CHECK(words_of(R"({"light":{"shaded":false}})") == "switched shading off");
    CHECK(words_of(R"({"probe":{"only_unpainted":true}})") == "switched protection of painted voxels on");
    CHECK(words_of(R"({"probe":{"density":{"offset":40}}})") == "switched density painting on");
    CHECK(words_of(R"({"interaction":{"pivot":"probe"}})") ==
          "set pivot of turning from the centre of the view to the probe");
    CHECK(words_of(R"({"interaction":{"frames_per_second":60}})") == "set frame rate from 30 to 60 frames per second");
}

TEST_CASE("numbers are told so that they differ, integers with all of their digits")
{
    CHECK(words_of(R"({"view":{"slices":{"white":1048576}}})", R"({"view":{"slices":{"white":65535}}})") ==
          "set white level of the slices from 65535 to 1048576");
    CHECK(words_of(R"({"light":{"ambient":0.500002}})", R"({"light":{"ambient":0.500001}})") ==
          "set ambient light from 0.500001 to 0.500002");
}

TEST_CASE("changes of a group are told with its name")
{
    const char* const stem = R"({"groups":{"3":{"name":"stem","color":"#ff0000"}}})";
    CHECK(words_of(R"({"groups":{"3":{"name":"stem"}}})") == "named group 3 stem");
    CHECK(words_of(R"({"groups":{"3":{"name":"leaf"}}})", stem) == "renamed group 3 from stem to leaf");
    CHECK(words_of(R"({"groups":{"3":{"color":"#00ff00"}}})", stem) == "changed the colour of group 3 (stem)");
    CHECK(words_of(R"({"groups":{"3":{"color":null}}})", stem) == "reset the colour of group 3 (stem)");
    CHECK(words_of(R"({"groups":{"3":{"visible":false,"locked":true}}})", stem) ==
          "locked group 3 (stem) and hid group 3 (stem)");
    CHECK(words_of(R"({"groups":{"3":{"parent":2}}})", stem) == "moved group 3 (stem) below group 2");
    CHECK(words_of(R"({"groups":{"3":{"opacity":0.25}}})", stem) == "set the opacity of group 3 (stem) from 1 to 0.25");
}

TEST_CASE("a group without settings has its default look, and only what differs from that was changed")
{
    CHECK(words_of(R"({"groups":{"3":{"visible":false}}})") == "hid group 3");
    CHECK(words_of(R"({"groups":{"3":{"locked":true}}})") == "locked group 3");
    CHECK(words_of(R"({"groups":{"2":{"opacity":0.89}}})") == "set the opacity of group 2 from 1 to 0.89");
    CHECK(words_of(R"({"groups":{"1":{"color":"#20b060"}}})") == "changed the colour of group 1");
    CHECK(words_of(R"({"groups":{"3":{"parent":2,"color":"#20b060"}}})") ==
          "changed the colour of group 3 and moved group 3 below group 2");
    CHECK(words_of(R"({"groups":{"1":{"visible":false},"2":{"visible":false}}})") == "hid group 1 and hid group 2");
    const char* const clear = R"({"groups":{"2":{"opacity":0.5},"3":{"parent":2}}})";
    CHECK(words_of(R"({"groups":{"3":{"opacity":0.25}}})", clear) == "set the opacity of group 3 from 0.5 to 0.25");
    CHECK(words_of(R"({"groups":{"2":{"opacity":0.250001}}})", R"({"groups":{"2":{"opacity":0.250002}}})") ==
          "set the opacity of group 2 to 0.25");
    // What the action New group does.
    CHECK(words_of(R"({"groups":{"3":{"name":"group 3"}}})") == "added group 3");
    CHECK(words_of(R"({"groups":{"3":null}})", clear) == "removed the look of group 3");
}

TEST_CASE("moved planes and measurements are told, not the numbers of their corners and points")
{
    const char* const cut = R"({"cut":{"lower":[20,0,0],"upper":[60,1048576,1048576]}})";
    CHECK(words_of(R"({"cut":{"upper":[60.4,1048576,1048576]}})") == "moved the far x cutting plane to voxel 60");
    CHECK(words_of(R"({"cut":{"lower":[0,3,0]}})", cut) ==
          "removed the near x cutting plane and moved the near y cutting plane to voxel 3");
    CHECK(words_of(R"({"cut":null})", cut) == "removed the cutting planes");
    const char* const oblique = R"({"cut":{"plane_normal":[1,0,-2],"plane_point":[5,5,5]}})";
    CHECK(words_of(oblique) == "added an oblique cutting plane");
    CHECK(words_of(R"({"cut":{"plane_point":[5,6,5]}})", oblique) == "moved the oblique cutting plane");
    CHECK(words_of(R"({"cut":{"plane_normal":[1,0,2]}})", oblique) == "tilted the oblique cutting plane");
    CHECK(words_of(R"({"cut":{"plane_normal":[-1,0,2]}})", oblique) == "flipped the oblique cutting plane");
    CHECK(words_of(R"({"cut":null})", oblique) == "removed the oblique cutting plane");
    const char* const one = R"({"measurements":[{"from":[0,0,0],"to":[1,2,3]}]})";
    CHECK(words_of(one) == "measured a distance");
    CHECK(words_of(R"({"measurements":null})", one) == "removed all measurements");
    const char* const named = R"({"measurements":[{"name":"stem","points":[[0,0,0],[1,2,3]]}]})";
    CHECK(words_of(R"({"measurements":[{"name":"petiole","points":[[0,0,0],[1,2,3]]}]})", named) ==
          R"(renamed the measurement "stem" to "petiole")");
    CHECK(words_of(R"({"measurements":[{"name":"stem","points":[[0,0,0],[1,2,3]]},
                       {"kind":"angle","points":[[0,0,0],[1,2,3],[4,5,6]]}]})",
                   named) == "measured an angle");
}

TEST_CASE("meshes are told by name")
{
    const char* const one = R"({"meshes":[{"file":"a/vein.stl"}]})";
    const char* const two = R"({"meshes":[{"file":"a/vein.stl"},{"file":"/b/stem.ply"}]})";
    CHECK(words_of(one) == "showed the mesh vein.stl");
    CHECK(words_of(two, one) == "showed the mesh stem.ply");
    CHECK(words_of(two) == "showed 2 meshes");
    CHECK(words_of(R"({"meshes":[{"file":"/b/stem.ply"}]})", two) == "removed the mesh vein.stl");
    CHECK(words_of(R"({"meshes":null})", one) == "removed the mesh vein.stl");
    CHECK(words_of(R"({"meshes":null})", two) == "removed all meshes");
    CHECK(words_of(R"({"meshes":[{"file":"a/vein.stl","shown":false}]})", one) == "hid the mesh vein.stl");
    CHECK(words_of(one, R"({"meshes":[{"file":"a/vein.stl","shown":false}]})") == "showed the mesh vein.stl");
    CHECK(words_of(R"({"meshes":[{"file":"a/vein.stl","color":"#ff0000"}]})", one) ==
          "changed the colour of the mesh vein.stl");
    CHECK(words_of(R"({"meshes":[{"file":"stem.stl"}]})", one) == "changed the meshes");
}

TEST_CASE("a changed curve of ambient occlusion is told as one, not as the numbers of its points")
{
    const char* const two = R"({"light":{"occlusion":{"mapping":[{"arrives":0,"seen":0},{"arrives":1,"seen":1}]}}})";
    const char* const other =
        R"({"light":{"occlusion":{"mapping":[{"arrives":0,"seen":0},{"arrives":1,"seen":0.5}]}}})";
    const char* const three =
        R"({"light":{"occlusion":{"mapping":[{"arrives":0,"seen":0},{"arrives":0.5,"seen":1},{"arrives":1,"seen":1}]}}})";
    CHECK(words_of(two) == "set curve of ambient occlusion to 2 points");
    CHECK(words_of(other, two) == "changed curve of ambient occlusion");
    CHECK(words_of(three, two) == "set curve of ambient occlusion from 2 points to 3 points");
    CHECK(words_of(R"({"light":{"occlusion":{"mapping":null}}})", two) ==
          "reset curve of ambient occlusion to the default");
}

TEST_CASE("each setting has a label, and each label is that of a setting")
{
    std::vector<std::string> keys;
    for (const SessionKey& key : keys_of([](Fields& f) {
             static Session session;
             setting_fields(f, session);
         }))
        keys.push_back(key.name);
    for (const SettingLabel& label : setting_labels()) {
        CAPTURE(label.key);
        CHECK(std::ranges::find(keys, label.key) != keys.end());
    }
    for (const std::string& key : keys) {
        CAPTURE(key);  // without a label, messages and the palette show the key
        const bool is_group = key == "groups.N";
        CHECK((is_group || std::ranges::find(setting_labels(), key, &SettingLabel::key) != setting_labels().end()));
    }
    REQUIRE(label_of_setting("groups.3.color"));
    CHECK(label_of_setting("groups.3.color")->label == "colour of a group");
    CHECK_FALSE(label_of_setting("light"));
}

TEST_CASE("numbers for reading have four digits, no exponent in ordinary ranges, and integers all of theirs")
{
    CHECK(number_in_words(0.0) == "0");
    CHECK(number_in_words(-0.0) == "0");
    CHECK(number_in_words(1048576.0) == "1048576");
    CHECK(number_in_words(-12080.0) == "-12080");
    CHECK(number_in_words(12345.6) == "12346");
    CHECK(number_in_words(0.1) == "0.1");
    CHECK(number_in_words(1.0 / 3.0) == "0.3333");
    CHECK(number_in_words(0.00123456) == "0.001235");
    CHECK(number_in_words(99.996) == "100");
    CHECK(number_in_words(1e-7) == "1e-07");
    CHECK(number_in_words(1e300) == "1e+300");
    CHECK(number_in_words(std::numeric_limits<double>::infinity()) == "inf");
    CHECK(capitalised("set shading") == "Set shading");
    CHECK(capitalised("") == "");
}
