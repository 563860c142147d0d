// Scene on a server: example_remote_scene ADDRESS. Start the server with `octopair serve --listen ADDRESS`.
#include <octopair/octopair.hpp>
#include <octopair/remote_scene.hpp>

#include <cstdio>
#include <cstdlib>
#include <vector>

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: %s ADDRESS (unix:PATH or HOST:PORT)\n", argv[0]);
        return EXIT_FAILURE;
    }
    try {
        octopair::RemoteScene scene = octopair::connect_scene(argv[1]);
        const std::vector<octopair::Box3f> cubes = {{{0, 0, 0}, {1, 1, 1}}, {{5, 0, 0}, {6, 1, 1}}};
        std::vector<octopair::ObjectId> ids(cubes.size());
        scene.add(octopair::Objects{octopair::Boxes(std::span(cubes))}, ids);
        (void)scene.step();

        // The first cube flies through the second. Each step sends only the box of the moved cube to the server.
        for (int frame = 1; frame <= 8; ++frame) {
            const auto x = float(frame);
            const octopair::Box3f there = {{x, 0, 0}, {x + 0.5f, 1, 1}};
            scene.move(std::span(ids).first(1), std::span(&there, 1));
            const octopair::StepResult& step = scene.step();  // throws if no server can be reached for 30 s
            for (const octopair::Pair& pair : step.began)
                std::printf("frame %d: %u and %u meet\n", frame, pair.a, pair.b);
            for (const octopair::Pair& pair : step.ended)
                std::printf("frame %d: %u and %u part\n", frame, pair.a, pair.b);
        }
    } catch (const octopair::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return EXIT_FAILURE;
    }
}
