// A program that shows a scene in a browser: two boxes, which meet in the second step. Prints the address of the page.
#include <octopair/octopair.hpp>
#include <octopair/view.hpp>

#include <cstdio>
#include <vector>

int main() {
    try {
        octopair::Scene scene;
        std::vector<octopair::ObjectId> ids(2);
        scene.add({std::vector<octopair::Box3f>{{{0, 0, 0}, {1, 1, 1}}, {{5, 5, 5}, {6, 6, 6}}}}, ids);
        octopair::View view(scene);
        view.show(scene.step());
        scene.move(std::vector{ids[1]}, std::vector<octopair::Box3f>{{{1, 0, 0}, {2, 1, 1}}});
        const octopair::StepResult met = scene.step();
        view.show(met);
        std::printf("%s\n", view.address().c_str());
        return met.began.size() == 1 ? 0 : 1;
    } catch (const octopair::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
