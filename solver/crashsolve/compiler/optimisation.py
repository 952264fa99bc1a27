"""From a text in LLVM's language to the machine code of this processor."""

from functools import cache

import llvmlite.binding as llvm

from crashsolve.compiler import machine


@cache
def _target(vectors: bool) -> llvm.TargetMachine:
    """This processor, and LLVM's options for it, which are set once."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    if vectors:
        # loops over lanes are not unrolled before they are vectorised, those over components are
        llvm.set_option("", "-unroll-full-max-count=8")
    else:
        # loops over rows and bodies are short: a copy for many turns costs a quarter of the time
        # of compiling, and saves none
        llvm.set_option("", "-unroll-runtime=false")
    return machine.host_machine(vectors)


def object_code(text: str, vectors: bool) -> bytes:
    """Machine code of a text; loops over lanes serve elements in blocks."""
    target = _target(vectors)
    module = llvm.parse_assembly(text)
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    # kernels have no statements side by side that could be joined, and the search takes time
    options.loop_vectorization, options.slp_vectorization = True, False
    builder = llvm.create_pass_builder(target, options)
    passes = builder.getModulePassManager() if vectors else _scalar_passes()
    passes.run(module, builder)
    code: bytes = target.emit_object(module)
    return code


def _scalar_passes() -> llvm.ModulePassManager:
    """Passes for numbers one by one: a third of the time of LLVM's first level, for code as fast.

    Small functions become part of their callers first (translation/module.py marks them), so none
    is optimised by itself. What the emission of code finds anyway, as common expressions of a
    block, is not searched for.
    """
    passes = llvm.create_new_module_pass_manager()
    passes.add_always_inliner_pass()
    passes.add_global_dead_code_eliminate_pass()
    passes.add_sroa_pass()
    passes.add_simplify_cfg_pass()
    passes.add_instruction_combine_pass()
    passes.add_simplify_cfg_pass()
    # loops over components; then their indices are constant
    passes.add_loop_rotate_pass()
    passes.add_loop_unroll_pass()
    passes.add_sroa_pass()
    passes.add_instruction_combine_pass()
    passes.add_simplify_cfg_pass()
    return passes
