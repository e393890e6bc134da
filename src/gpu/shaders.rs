//! The compiled shaders: one `NAME_STAGE: &[u32]` of SPIR-V for each file in `shaders/` (see
//! build.rs).

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use naga::{AddressSpace, Block, Expression, Function, Handle, Module, Statement};

    /// The dependence of a value, in rising order.
    #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    enum Made {
        Constant,
        /// The same for all pixels of a picture.
        Uniform,
        Varying,
    }

    struct Walk<'a> {
        module: &'a Module,
        function: &'a Function,
        /// The dependencies of local variables.
        locals: Vec<Made>,
    }

    impl Walk<'_> {
        fn made(&self, value: Handle<Expression>) -> Made {
            let all = |values: &[Handle<Expression>]| {
                values.iter().map(|v| self.made(*v)).max().unwrap_or(Made::Constant)
            };
            match &self.function.expressions[value] {
                Expression::Literal(_) | Expression::Constant(_) | Expression::ZeroValue(_) => {
                    Made::Constant
                }
                Expression::GlobalVariable(global) => {
                    match self.module.global_variables[*global].space {
                        AddressSpace::Uniform | AddressSpace::Immediate => Made::Uniform,
                        _ => Made::Varying,
                    }
                }
                Expression::LocalVariable(local) => self.locals[local.index()],
                Expression::Load { pointer: inner }
                | Expression::AccessIndex { base: inner, .. }
                | Expression::Splat { value: inner, .. }
                | Expression::Swizzle { vector: inner, .. }
                | Expression::Unary { expr: inner, .. }
                | Expression::As { expr: inner, .. }
                | Expression::Relational { argument: inner, .. } => self.made(*inner),
                Expression::Access { base, index } => all(&[*base, *index]),
                Expression::Binary { left, right, .. } => all(&[*left, *right]),
                Expression::Select { condition, accept, reject } => {
                    all(&[*condition, *accept, *reject])
                }
                Expression::Compose { components, .. } => all(components),
                Expression::Math { arg, arg1, arg2, arg3, .. } => {
                    let args: Vec<_> =
                        [Some(*arg), *arg1, *arg2, *arg3].into_iter().flatten().collect();
                    all(&args)
                }
                _ => Made::Varying,
            }
        }

        /// Records stores to local variables.
        fn note_stores(&mut self, block: &Block) {
            for_each_statement(block, &mut |statement| {
                if let Statement::Store { pointer, value } = statement {
                    let mut place = *pointer;
                    while let Expression::AccessIndex { base, .. }
                    | Expression::Access { base, .. } = self.function.expressions[place]
                    {
                        place = base;
                    }
                    if let Expression::LocalVariable(local) = self.function.expressions[place] {
                        let made = self.made(*value);
                        let known = &mut self.locals[local.index()];
                        *known = made.max(*known);
                    }
                }
            });
        }

        fn branches_by_uniforms(&self, block: &Block) -> usize {
            let mut count = 0;
            for_each_statement(block, &mut |statement| {
                let condition = match statement {
                    Statement::If { condition, .. } => Some(*condition),
                    Statement::Switch { selector, .. } => Some(*selector),
                    Statement::Loop { break_if, .. } => *break_if,
                    _ => None,
                };
                count += usize::from(condition.is_some_and(|c| self.made(c) == Made::Uniform));
            });
            count
        }
    }

    fn for_each_statement(block: &Block, f: &mut dyn FnMut(&Statement)) {
        for statement in block {
            f(statement);
            match statement {
                Statement::Block(inner) => for_each_statement(inner, f),
                Statement::If { accept, reject, .. } => {
                    for_each_statement(accept, f);
                    for_each_statement(reject, f);
                }
                Statement::Switch { cases, .. } => {
                    cases.iter().for_each(|case| for_each_statement(&case.body, f));
                }
                Statement::Loop { body, continuing, .. } => {
                    for_each_statement(body, f);
                    for_each_statement(continuing, f);
                }
                _ => {}
            }
        }
    }

    fn branches_by_uniforms(text: &str) -> usize {
        let module = naga::front::wgsl::parse_str(text).unwrap();
        let entries = module.entry_points.iter().map(|entry| &entry.function);
        let functions = module.functions.iter().map(|(_, function)| function);
        let count = |function: &Function| {
            let locals = vec![Made::Constant; function.local_variables.len()];
            let mut walk = Walk { module: &module, function, locals };
            // A stored value may depend on a store later in a loop.
            for _ in 0..3 {
                walk.note_stores(&function.body);
            }
            walk.branches_by_uniforms(&function.body)
        };
        entries.chain(functions).map(count).sum()
    }

    #[test]
    fn no_uniform_decides_a_branch() {
        for_each_text(|name, text| assert_eq!(branches_by_uniforms(text), 0, "{name}"));
    }

    /// Calls `f` with the name and expanded source of every stage.
    fn for_each_text(f: impl Fn(&str, &str)) {
        let mut shaders = 0;
        for entry in fs::read_dir(Path::new(env!("OUT_DIR"))).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|ending| ending == "wgsl") {
                f(&path.display().to_string(), &fs::read_to_string(&path).unwrap());
                shaders += 1;
            }
        }
        assert!(shaders > 10);
    }

    /// Checks the SPIR-V version: from 1.5 on, function variables may not have structure types with offsets, as all of
    /// naga's have.
    #[test]
    fn shaders_are_of_a_version_in_which_structures_of_variables_may_have_offsets() {
        assert!(super::ALL.len() > 10);
        for (name, words) in super::ALL {
            assert_eq!(words[0], 0x0723_0203, "{name} is SPIR-V");
            assert!(words[1] <= 0x0001_0400, "{name} is of version {:#x}", words[1]);
        }
    }

    /// Checks the constants: numbers below 1.2e-38, and results with them, are 0 on devices that flush denormals.
    #[test]
    fn no_number_of_a_shader_is_so_small_that_a_device_may_take_it_for_zero() {
        let smallest = |text: &str| {
            let module = naga::front::wgsl::parse_str(text).unwrap();
            let functions = module.functions.iter().map(|(_, function)| function);
            let entries = module.entry_points.iter().map(|entry| &entry.function);
            let local = functions.chain(entries).flat_map(|function| function.expressions.iter());
            let least = |least: f32, expression: &Expression| match expression {
                Expression::Literal(naga::Literal::F32(number)) if *number != 0.0 => {
                    least.min(number.abs())
                }
                _ => least,
            };
            module.global_expressions.iter().chain(local).map(|(_, e)| e).fold(f32::MAX, least)
        };
        let shader = |number: &str| {
            format!(
                "@fragment fn main(@builtin(position) p: vec4<f32>) -> @location(0) f32 {{
                     return max(p.x, {number});
                 }}"
            )
        };
        assert_eq!(smallest(&shader("2.5e-38")), 2.5e-38);
        for_each_text(|name, text| assert!(smallest(text) >= 1e-30, "{name}"));
    }

    #[test]
    fn branches_by_uniforms_are_found() {
        let shader = |body: &str| {
            format!(
                "struct S {{ n: u32, v: vec4<f32> }}
                 @group(0) @binding(0) var<uniform> s: S;
                 @fragment fn main(@builtin(position) p: vec4<f32>) -> @location(0) vec4<f32> {{
                     var sum = p.x;
                     {body}
                     return vec4<f32>(sum);
                 }}"
            )
        };
        let count = |body| branches_by_uniforms(&shader(body));
        assert_eq!(count("if s.n != 0u { sum += 1.0; }"), 1);
        assert_eq!(count("for (var i = 0u; i < s.n; i++) { sum += s.v[i]; }"), 1);
        assert_eq!(count("switch s.n + 1u { case 2u: { sum = 1.0; } default: {} }"), 1);
        assert_eq!(count("if p.x < s.v.x { sum += 1.0; }"), 0);
        assert_eq!(count("for (var i = 0u; i < 4u; i++) { sum += s.v[i]; }"), 0);
        assert_eq!(count("sum = select(1.0, 2.0, s.n != 0u);"), 0);
    }
}
