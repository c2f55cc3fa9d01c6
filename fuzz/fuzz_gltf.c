/* fuzz_gltf.c - any bytes as a glTF scene, .gltf or .glb: no crash, and a scene that was accepted holds its
 * promises. */
#include "gltf/gltf.h"
#include "fuzz_accepted.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    lc_scene *scene;
    if (lc_scene_create(fuzz_context(), &scene)) abort();
    if (lc_gltf_parse_memory(scene, "fuzz", data, size) == LC_OK) require_scene(scene);
    lc_scene_destroy(scene);
    return 0;
}
