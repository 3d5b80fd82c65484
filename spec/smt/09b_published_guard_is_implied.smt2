; THEOREM    09b: what our guard admits, the published guard admits.
; ASSUMED    As in 09a; our guard is satisfied.
; CONCLUDED  The published guard is satisfied: ours is at least as strong.
; SOURCE     Mitsch, Ghorbal, Vogelbacher, Platzer, IJRR 36(12), 2017, Theorem 2.
; TWIN       our way to rest forgets the reaction time.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const A Real)        ; greatest acceleration
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const s Real)        ; robot's own way since the thing was seen
(declare-const age Real)      ; time since the thing was seen
(declare-const d Real)        ; clearance when the thing was seen
(declare-const c Real)        ; commanded speed
(declare-const u Real)        ; bound of the robot's present speed
; Formulas, times 2b (00)
(define-fun need_2b ((w Real)) Real
  (+ (* kappa (+ (* 2 b s) (* 2 b w eps) (* w w))) (* 2 V (+ (* b age) (* b eps) w))))
(define-fun fastest ((c Real) (u Real)) Real (ite (>= (+ c (* A eps)) u) (+ c (* A eps)) u))
(define-fun published_2b ((v Real)) Real
  (+ (* v v) (* 2 V v) (* (+ A b) (+ (* A eps eps) (* 2 eps (+ v V))))))

; Assumptions
(assert (>= A 0))
(assert (> b 0))
(assert (> eps 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= s 0))
(assert (>= age 0))
(assert (>= c 0))
(assert (>= u 0))
(assert (and (= kappa 1) (= s 0) (= age 0)))
(assert (<= u (+ c (* A eps))))
(assert (<= (need_2b (fastest c u)) (* 2 b d)))

; Conclusion, negated
(assert (not (<= (published_2b c) (* 2 b d))))
(check-sat)
