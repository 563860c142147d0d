// Scenes of every kind with seed 1, and the number and hash of their pairs. The naive and the LBVH baseline computed
// the values, with both compilers. The values change only if a scene changes, which breaks all users' results.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>

namespace octopair::test {

struct Pinned {
    std::string_view kind;
    std::uint64_t objects;
    std::uint64_t pairs;
    std::uint64_t pair_hash;   ///< of the ascending pairs (hash.hpp)
    std::uint64_t scene_hash;  ///< of the boxes
};

inline constexpr Pinned pinned_scenes[] = {
    {"uniform", 20000, 9783, 0x92ea6933d70809b5, 0x9538ea30052ce528},
    {"dense", 20000, 94477, 0xfe5027267dcedaad, 0x73fd3259d10bfd57},
    {"mixed", 20000, 42607, 0xeea9eb6d866d6abc, 0xccc0bc39b36bc69e},
    {"clustered", 20000, 48186, 0x3e395acd0c3e4445, 0x621ecef9f6d043bf},
    {"flat", 20000, 15088, 0xc748e75000fc5dce, 0x2f21a735700f81ae},
    {"world10", 20000, 206593, 0xade3351d1637cfff, 0x4609a18058a20c74},
    {"same-x", 20000, 9852, 0xdeb6c18fbbba813d, 0xf1fcda5a18552e58},
    {"same-y", 20000, 10077, 0x961ac90f6a66aa09, 0xf39ce7cfc612aa75},
    {"same-z", 20000, 9935, 0x06eca809276acc77, 0xe315f5d8f7ab8fd4},
    {"coincident", 5000, 12497500, 0xa39632666b879e4d, 0x227a84ba6a8dd6c5},
    {"plates-x", 20000, 18, 0x93bef1439fbcc7fb, 0x083a179ae03a168c},
    {"plates-y", 20000, 18, 0x93bef1439fbcc7fb, 0x126106bcc2a8f319},
    {"plates-z", 20000, 18, 0x93bef1439fbcc7fb, 0x77efdc2700f2f6c2},
    {"sheets-x", 20000, 7842, 0x63de6065672aa995, 0xa668b4186e6b1635},
    {"sheets-y", 20000, 7756, 0x8dca4b7df47127a2, 0x542fe1977fcbb116},
    {"sheets-z", 20000, 7858, 0x98d9bf2ddc0d96f6, 0x86bbf4fb4d1a17fd},
    {"rods", 20000, 39303, 0xfaa83d614567bbca, 0x403c61404bc3d74d},
    {"micro20", 20000, 10579, 0xc842a3b11332b76f, 0xfcbbb9134632fd28},
    {"far-outlier", 20000, 9781, 0x706e1083745b2ad8, 0x2a190dca31ceeffa},
    {"brownian", 20000, 9783, 0x92ea6933d70809b5, 0x9538ea30052ce528},
};

inline const Pinned& pinned_scene(std::string_view kind) {
    const auto found = std::find_if(std::begin(pinned_scenes), std::end(pinned_scenes),
                                    [&](const Pinned& pinned) { return pinned.kind == kind; });
    if (found == std::end(pinned_scenes)) throw std::out_of_range("nothing is pinned for " + std::string(kind));
    return *found;
}

}  // namespace octopair::test
