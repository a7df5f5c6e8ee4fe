// Times of day as text.

#include <doctest/doctest.h>

#include <limits>

#include "engine/annotation/script/log_time.h"
#include "engine/annotation/script/script.h"
#include "engine/base/json.h"

using namespace shvr;

TEST_CASE("times are written in UTC with milliseconds")
{
    CHECK(utc_text(0) == "1970-01-01T00:00:00.000Z");
    CHECK(utc_text(-1) == "1969-12-31T23:59:59.999Z");
    CHECK(utc_text(1795953600000 + 3661005) == "2026-11-29T13:01:01.005Z");
    CHECK(utc_text(951782400000) == "2000-02-29T00:00:00.000Z");
    // Other years have no such text.
    CHECK(utc_text(std::numeric_limits<int64_t>::max()) == "9999-12-31T23:59:59.999Z");
    CHECK(utc_text(std::numeric_limits<int64_t>::min()) == "0000-01-01T00:00:00.000Z");
}

TEST_CASE("scripts ignore the time of a log's line, and name no such key where another is wrong")
{
    const std::string line = with_time(line_of(ScriptOp(UndoOp{.count = 3})), 0);
    CHECK(line == R"({"op":"undo","count":3,"time":"1970-01-01T00:00:00.000Z"})");
    const JsonDocument read(line, "a.jsonl");
    CHECK(std::get<UndoOp>(read_script_op(read.root())).count == 3);
    const JsonDocument wrong(R"({"op":"undo","counts":3})", "a.jsonl");
    std::string said;
    try {
        static_cast<void>(read_script_op(wrong.root()));
    } catch (const std::exception& error) {
        said = error.what();
    }
    CHECK(said.find("unknown key counts; expected one of: op, count") != std::string::npos);
    CHECK(said.find("time") == std::string::npos);
}
