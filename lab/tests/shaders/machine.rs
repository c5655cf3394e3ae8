//! A machine that runs shaders as naga reads them: straight lines, calls, and flat memory.

use std::collections::HashMap;

use naga::{
    AddressSpace, Arena, BinaryOperator, Binding, BuiltIn, Expression, Function, GlobalVariable, Handle,
    Literal, LocalVariable, MathFunction, Module, ScalarKind, Statement, Type, TypeInner,
};

/// A scalar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scalar {
    U(u32),
    I(i32),
    F(f32),
}

use Scalar::{F, I, U};

impl Scalar {
    fn of(literal: Literal) -> Self {
        match literal {
            Literal::U32(value) => U(value),
            Literal::I32(value) => I(value),
            Literal::F32(value) => F(value),
            other => panic!("no literal of this machine: {other:?}"),
        }
    }

    fn cast(self, kind: ScalarKind) -> Self {
        match (self, kind) {
            (U(value), ScalarKind::Sint) => I(value as i32),
            (I(value), ScalarKind::Uint) => U(value as u32),
            (U(value), ScalarKind::Float) => F(value as f32),
            (I(value), ScalarKind::Float) => F(value as f32),
            (F(value), ScalarKind::Uint) => U(value as u32),
            (F(value), ScalarKind::Sint) => I(value as i32),
            (same, _) => same,
        }
    }

    pub fn index(self) -> usize {
        match self {
            U(value) => value as usize,
            I(value) => usize::try_from(value).unwrap(),
            F(value) => panic!("{value} is no index"),
        }
    }

    pub fn float(self) -> f32 {
        match self {
            F(value) => value,
            other => panic!("{other:?} is no float"),
        }
    }
}

/// Where a value lies: scalars of one of the machine's memories.
#[derive(Clone, Copy, Debug)]
struct Pointer {
    memory: usize,
    offset: usize,
    /// What lies there; nothing for a part of a vector.
    ty: Option<Handle<Type>>,
}

#[derive(Clone, Debug)]
enum Value {
    Scalars(Vec<Scalar>),
    Pointer(Pointer),
    /// A texture, by its binding.
    Texture(u32),
}

impl Value {
    fn scalars(self) -> Vec<Scalar> {
        match self {
            Self::Scalars(scalars) => scalars,
            other => panic!("{other:?} is no number"),
        }
    }
}

/// Answers what a texture holds at a column, a row and a layer.
type Fetch<'a> = Box<dyn Fn(u32, [usize; 3]) -> [f32; 4] + 'a>;

/// A module and its memory.
pub struct Machine<'a> {
    module: &'a Module,
    memories: Vec<Vec<Scalar>>,
    globals: HashMap<Handle<GlobalVariable>, usize>,
    fetch: Fetch<'a>,
    /// Of one invocation.
    built_in: HashMap<BuiltIn, Vec<Scalar>>,
}

/// A call of a function.
struct Call<'a> {
    function: &'a Function,
    arguments: Vec<Value>,
    locals: HashMap<Handle<LocalVariable>, usize>,
    known: HashMap<Handle<Expression>, Value>,
}

impl<'a> Machine<'a> {
    /// The machine with these buffers, by their bindings.
    pub fn new(module: &'a Module, mut buffers: HashMap<u32, Vec<Scalar>>, fetch: Fetch<'a>) -> Self {
        let mut machine =
            Self { module, memories: Vec::new(), globals: HashMap::new(), fetch, built_in: HashMap::new() };
        for (handle, global) in module.global_variables.iter() {
            let memory = match (&global.binding, global.space) {
                (Some(binding), AddressSpace::Storage { .. } | AddressSpace::Uniform) => {
                    buffers.remove(&binding.binding).unwrap_or_default()
                }
                (None, AddressSpace::Private) => vec![F(f32::NAN); machine.len(global.ty)],
                _ => Vec::new(),
            };
            machine.globals.insert(handle, machine.memories.len());
            machine.memories.push(memory);
        }
        machine
    }

    /// What the buffer with this binding holds.
    pub fn buffer(&self, binding: u32) -> &[Scalar] {
        let mut all = self.module.global_variables.iter();
        let of = |global: &GlobalVariable| global.binding.is_some_and(|found| found.binding == binding);
        &self.memories[self.globals[&all.find(|(_, global)| of(global)).unwrap().0]]
    }

    /// Runs the entry point once.
    pub fn invoke(&mut self, id: [u32; 3], groups: [u32; 3]) {
        self.built_in.insert(BuiltIn::GlobalInvocationId, id.map(U).to_vec());
        self.built_in.insert(BuiltIn::NumWorkGroups, groups.map(U).to_vec());
        let before = self.memories.len();
        let function = &self.module.entry_points[0].function;
        let built_in = |argument: &naga::FunctionArgument| match argument.binding {
            Some(Binding::BuiltIn(built_in)) => Value::Scalars(self.built_in[&built_in].clone()),
            ref other => panic!("no argument of this machine: {other:?}"),
        };
        let arguments = function.arguments.iter().map(built_in).collect();
        self.run(function, arguments);
        self.memories.truncate(before);
    }

    /// Calls the function of this name.
    pub fn call(&mut self, name: &str, arguments: &[&[Scalar]]) -> Vec<Scalar> {
        let mut all = self.module.functions.iter();
        let named = all.find(|(_, function)| function.name.as_deref() == Some(name));
        let arguments = arguments.iter().map(|scalars| Value::Scalars(scalars.to_vec())).collect();
        self.run(named.unwrap_or_else(|| panic!("there is no {name}")).1, arguments).unwrap().scalars()
    }

    /// Scalars of a value of this type; of an array without end none.
    fn len(&self, ty: Handle<Type>) -> usize {
        match &self.module.types[ty].inner {
            TypeInner::Scalar(_) => 1,
            TypeInner::Vector { size, .. } => *size as usize,
            TypeInner::Struct { members, .. } => members.iter().map(|member| self.len(member.ty)).sum(),
            _ => 0,
        }
    }

    fn run(&mut self, function: &'a Function, arguments: Vec<Value>) -> Option<Value> {
        let mut call = Call { function, arguments, locals: HashMap::new(), known: HashMap::new() };
        for (handle, local) in function.local_variables.iter() {
            let memory = match local.init {
                Some(init) => self.value(&call, init).scalars(),
                None => vec![F(f32::NAN); self.len(local.ty)],
            };
            call.locals.insert(handle, self.memories.len());
            self.memories.push(memory);
        }
        self.block(&mut call, &function.body).flatten()
    }

    /// Runs a block; what it returns, if it does.
    fn block(&mut self, call: &mut Call<'a>, block: &'a naga::Block) -> Option<Option<Value>> {
        for statement in block.iter() {
            match statement {
                Statement::Emit(range) => {
                    for handle in range.clone() {
                        let value = self.evaluate(call, handle);
                        call.known.insert(handle, value);
                    }
                }
                Statement::Block(inner) => {
                    if let Some(returned) = self.block(call, inner) {
                        return Some(returned);
                    }
                }
                Statement::Store { pointer, value } => {
                    let Value::Pointer(Pointer { memory, offset, .. }) = self.value(call, *pointer) else {
                        panic!("a store goes to a pointer")
                    };
                    let scalars = self.value(call, *value).scalars();
                    self.memories[memory][offset..][..scalars.len()].copy_from_slice(&scalars);
                }
                Statement::Call { function, arguments, result } => {
                    let arguments = arguments.iter().map(|&argument| self.value(call, argument)).collect();
                    let returned = self.run(&self.module.functions[*function], arguments);
                    if let (Some(result), Some(returned)) = (result, returned) {
                        call.known.insert(*result, returned);
                    }
                }
                Statement::Return { value } => return Some(value.map(|value| self.value(call, value))),
                other => panic!("no statement of this machine: {other:?}"),
            }
        }
        None
    }

    /// An expression's value, as it was when it was emitted.
    fn value(&self, call: &Call, handle: Handle<Expression>) -> Value {
        call.known.get(&handle).cloned().unwrap_or_else(|| self.evaluate(call, handle))
    }

    fn constant(&self, handle: Handle<Expression>) -> Vec<Scalar> {
        let all = &self.module.global_expressions;
        match &all[handle] {
            Expression::Literal(literal) => vec![Scalar::of(*literal)],
            Expression::Constant(constant) => self.constant(self.module.constants[*constant].init),
            Expression::Compose { components, .. } => {
                components.iter().flat_map(|&part| self.constant(part)).collect()
            }
            Expression::Splat { size, value } => vec![self.constant(*value)[0]; *size as usize],
            other => panic!("no constant of this machine: {other:?}"),
        }
    }

    fn evaluate(&self, call: &Call, handle: Handle<Expression>) -> Value {
        let scalars = |handle| self.value(call, handle).scalars();
        let expressions: &Arena<Expression> = &call.function.expressions;
        Value::Scalars(match &expressions[handle] {
            Expression::Literal(literal) => vec![Scalar::of(*literal)],
            Expression::Constant(constant) => self.constant(self.module.constants[*constant].init),
            Expression::FunctionArgument(index) => return call.arguments[*index as usize].clone(),
            Expression::LocalVariable(local) => {
                let ty = Some(call.function.local_variables[*local].ty);
                return Value::Pointer(Pointer { memory: call.locals[local], offset: 0, ty });
            }
            Expression::GlobalVariable(global) => {
                let GlobalVariable { ty, space, binding, .. } = &self.module.global_variables[*global];
                return match (space, binding) {
                    (AddressSpace::Handle, Some(binding)) => Value::Texture(binding.binding),
                    _ => Value::Pointer(Pointer { memory: self.globals[global], offset: 0, ty: Some(*ty) }),
                };
            }
            Expression::Access { base, index } => {
                return self.part(self.value(call, *base), scalars(*index)[0].index());
            }
            Expression::AccessIndex { base, index } => {
                return self.part(self.value(call, *base), *index as usize);
            }
            Expression::Load { pointer } => {
                let Value::Pointer(Pointer { memory, offset, ty }) = self.value(call, *pointer) else {
                    panic!("a load comes from a pointer")
                };
                self.memories[memory][offset..][..ty.map_or(1, |ty| self.len(ty))].to_vec()
            }
            Expression::Compose { components, .. } => {
                components.iter().flat_map(|&part| scalars(part)).collect()
            }
            Expression::Splat { size, value } => vec![scalars(*value)[0]; *size as usize],
            Expression::Swizzle { size, vector, pattern } => {
                let vector = scalars(*vector);
                pattern[..*size as usize].iter().map(|&part| vector[part as usize]).collect()
            }
            // Bits that are taken for another kind are the same number modulo 2^32, if both are integers.
            Expression::As { expr, kind, convert } => {
                let is_integer = |kind: ScalarKind| matches!(kind, ScalarKind::Uint | ScalarKind::Sint);
                let cast = |scalar: Scalar| {
                    assert!(convert.is_some() || is_integer(*kind) && !matches!(scalar, F(_)));
                    scalar.cast(*kind)
                };
                scalars(*expr).into_iter().map(cast).collect()
            }
            Expression::Binary { op, left, right } => {
                let (left, right) = (scalars(*left), scalars(*right));
                let len = left.len().max(right.len());
                let at = |side: &[Scalar], place: usize| side[place.min(side.len() - 1)];
                (0..len).map(|place| binary(*op, at(&left, place), at(&right, place))).collect()
            }
            Expression::Math { fun: MathFunction::Round, arg, .. } => {
                scalars(*arg).into_iter().map(|scalar| F(scalar.float().round_ties_even())).collect()
            }
            Expression::ImageLoad { image, coordinate, array_index, level, .. } => {
                let Value::Texture(binding) = self.value(call, *image) else { panic!("no texture") };
                assert!(level.is_none_or(|level| scalars(level)[0].index() == 0), "there are no mips");
                let at = scalars(*coordinate);
                let layer = array_index.map_or(0, |layer| scalars(layer)[0].index());
                (self.fetch)(binding, [at[0].index(), at[1].index(), layer]).map(F).to_vec()
            }
            other => panic!("no expression of this machine: {other:?}"),
        })
    }

    /// An element, component or member.
    fn part(&self, whole: Value, index: usize) -> Value {
        let Pointer { memory, offset, ty } = match whole {
            Value::Pointer(pointer) => pointer,
            other => return Value::Scalars(vec![other.scalars()[index]]),
        };
        let (offset, ty) = match &self.module.types[ty.unwrap()].inner {
            TypeInner::Vector { .. } => (offset + index, None),
            TypeInner::Array { base, .. } => (offset + index * self.len(*base), Some(*base)),
            TypeInner::Struct { members, .. } => {
                let before: usize = members[..index].iter().map(|member| self.len(member.ty)).sum();
                (offset + before, Some(members[index].ty))
            }
            other => panic!("{other:?} has no parts"),
        };
        Value::Pointer(Pointer { memory, offset, ty })
    }
}

fn binary(op: BinaryOperator, left: Scalar, right: Scalar) -> Scalar {
    match (op, left, right) {
        (BinaryOperator::Add, U(a), U(b)) => U(a.wrapping_add(b)),
        (BinaryOperator::Multiply, U(a), U(b)) => U(a.wrapping_mul(b)),
        (BinaryOperator::Divide, U(a), U(b)) => U(a / b),
        (BinaryOperator::Modulo, U(a), U(b)) => U(a % b),
        (BinaryOperator::ShiftRight, U(a), U(b)) => U(a >> b),
        (BinaryOperator::Add, F(a), F(b)) => F(a + b),
        (BinaryOperator::Subtract, F(a), F(b)) => F(a - b),
        (BinaryOperator::Multiply, F(a), F(b)) => F(a * b),
        (BinaryOperator::Divide, F(a), F(b)) => F(a / b),
        other => panic!("no operation of this machine: {other:?}"),
    }
}
